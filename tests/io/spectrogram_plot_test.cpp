#include "io/figures/spectrogram_plot.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/errors.hpp"
#include "io/figures/amplitude_raster.hpp"
#include "io/results/spectrogram_file.hpp"
#include "tests/support/message_of.hpp"
#include "tests/support/program.hpp"

namespace stridor {
namespace {

using namespace test;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

// Columns 1 s apart, their pieces 2 s long; lines 0.5 Hz apart.
Spectrogram small_spectrogram(Eigen::Index lines, Eigen::Index columns) {
  Spectrogram spectrogram;
  for (Eigen::Index k = 0; k < lines; ++k)
    spectrogram.frequencies.push_back(0.5 * static_cast<double>(k));
  for (Eigen::Index j = 0; j < columns; ++j)
    spectrogram.times.push_back(1.0 + static_cast<double>(j));
  spectrogram.amplitude = Eigen::MatrixXd::Zero(lines, columns);
  spectrogram.noise_bandwidth = 0.75;
  return spectrogram;
}

// ---------------------------------------------------------------- raster

TEST(Rasterise, KeepsASingleCellWhereverItIs) {
  // 97 × 61 cells on a raster of 10 × 7: every one shows, in a cell that holds its place.
  std::mt19937 generator(3);
  for (int trial = 0; trial < 200; ++trial) {
    Spectrogram spectrogram = small_spectrogram(97, 61);
    const auto line = static_cast<Eigen::Index>(generator() % 97);
    const auto column = static_cast<Eigen::Index>(generator() % 61);
    spectrogram.amplitude(line, column) = 3.0;
    const AmplitudeRaster raster = rasterise(spectrogram, 48.0, 7, 10);
    Eigen::Index row = 0;
    Eigen::Index cell = 0;
    EXPECT_EQ(raster.amplitude.maxCoeff(&row, &cell), 3.0);
    const double time = spectrogram.times[static_cast<std::size_t>(column)];
    const double frequency = spectrogram.frequencies[static_cast<std::size_t>(line)];
    const double width = (raster.to - raster.from) / 10.0;
    const double height = raster.max_frequency / 7.0;
    // A piece reaches half a second, the first and the last a whole one; a line a quarter hertz.
    EXPECT_LE(raster.from + width * static_cast<double>(cell), time + 1.0);
    EXPECT_GE(raster.from + width * static_cast<double>(cell + 1), time - 1.0);
    EXPECT_LE(height * static_cast<double>(row), frequency + 0.25);
    EXPECT_GE(height * static_cast<double>(row + 1), frequency - 0.25);
  }
}

TEST(Rasterise, ReachesFromTheStartOfTheFirstPieceToTheEndOfTheLast) {
  const AmplitudeRaster raster = rasterise(small_spectrogram(5, 3), 1.6, 4, 8);
  EXPECT_EQ(raster.from, 0.0);
  EXPECT_EQ(raster.to, 4.0);
  EXPECT_EQ(raster.max_frequency, 1.6);
}

TEST(Rasterise, FinerRasterRepeatsEachSourceOverItsExtent) {
  Spectrogram spectrogram = small_spectrogram(3, 3);
  spectrogram.amplitude << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0;
  // Columns: 0 to 1.5, 1.5 to 2.5, 2.5 to 4 s in cells of 0.5 s; lines: 0 to 0.25, to 0.75, to 1.25
  // Hz in cells of 0.25 Hz. No edge is touched from the other side.
  const AmplitudeRaster raster = rasterise(spectrogram, 1.25, 5, 8);
  Eigen::MatrixXd expected(5, 8);
  expected << 1, 1, 1, 2, 2, 3, 3, 3,  //
      4, 4, 4, 5, 5, 6, 6, 6,          //
      4, 4, 4, 5, 5, 6, 6, 6,          //
      7, 7, 7, 8, 8, 9, 9, 9,          //
      7, 7, 7, 8, 8, 9, 9, 9;
  EXPECT_EQ(raster.amplitude, expected);
}

TEST(Rasterise, CoarserRasterTakesTheMaximum) {
  Spectrogram spectrogram = small_spectrogram(3, 3);
  spectrogram.amplitude << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0;
  const AmplitudeRaster raster = rasterise(spectrogram, 0.75, 1, 2);
  // Up to 0.75 Hz lie lines 0 and 1; the middle column touches both halves.
  Eigen::MatrixXd expected(1, 2);
  expected << 5, 6;
  EXPECT_EQ(raster.amplitude, expected);
}

TEST(Rasterise, SinglePieceFillsTheRaster) {
  Spectrogram spectrogram = small_spectrogram(2, 1);
  spectrogram.amplitude << 1.0, 2.0;
  const AmplitudeRaster raster = rasterise(spectrogram, 100.0, 3, 2);
  EXPECT_EQ(raster.max_frequency, 0.75);  // no line reaches farther
  EXPECT_EQ(raster.amplitude.minCoeff(), 1.0);
  EXPECT_EQ(raster.amplitude(2, 1), 2.0);
}

TEST(Rasterise, RejectsWhatItCannotUse) {
  const auto message = [](const Spectrogram& spectrogram, double highest, Eigen::Index rows) {
    return message_of<std::invalid_argument>([&] { rasterise(spectrogram, highest, rows, 4); });
  };
  EXPECT_THAT(message(Spectrogram{}, 1.0, 4), HasSubstr("without a column"));
  EXPECT_THAT(message(small_spectrogram(1, 1), 1.0, 4), HasSubstr("single line"));
  EXPECT_THAT(message(small_spectrogram(3, 3), 1.0, 0), HasSubstr("without cells"));
  EXPECT_THAT(message(small_spectrogram(3, 3), 0.0, 4), HasSubstr("frequency must be positive"));
  EXPECT_THAT(message(small_spectrogram(3, 3), std::nan(""), 4), HasSubstr("must be positive"));
}

TEST(HighestAmplitude, LeavesOutTheMeanAndWhatIsBeyondTheAxis) {
  Spectrogram spectrogram = small_spectrogram(5, 2);
  spectrogram.amplitude.col(1) << 9.0, 7.0, 1.0, 2.0, 8.0;
  EXPECT_EQ(highest_amplitude(spectrogram, 1.5, 2), 2.0);
  EXPECT_EQ(highest_amplitude(spectrogram, 1.5, 0), 9.0);
  EXPECT_EQ(highest_amplitude(spectrogram, 0.4, 2), 9.0);  // nothing but the mean
  EXPECT_EQ(highest_amplitude(small_spectrogram(5, 2), 2.0, 2), 0.0);
}

// ---------------------------------------------------------------- marks

MapArea map_of_ten_seconds() {
  MapArea map;
  map.width = 10.0;
  map.height = 6.0;
  map.from = 0.0;
  map.to = 10.0;
  map.max_frequency = 6000.0;
  return map;
}

SpectrogramMark mark(double from, double to, double frequency, std::string label = "1: 3 kHz") {
  return {from, to, frequency, std::move(label), "1", MarkStyle::found};
}

bool overlap(const PictureBox& a, const PictureBox& b) {
  return a.left < b.right && b.left < a.right && a.bottom < b.top && b.bottom < a.top;
}

TEST(PlaceMarks, BoxStandsAroundTheMarkAndTheLabelAboveIt) {
  const auto places = place_marks({mark(2.0, 5.0, 3000.0)}, map_of_ten_seconds());
  ASSERT_EQ(places.size(), 1u);
  EXPECT_DOUBLE_EQ(places[0].box.left, 2.0);
  EXPECT_DOUBLE_EQ(places[0].box.right, 5.0);
  EXPECT_DOUBLE_EQ(0.5 * (places[0].box.bottom + places[0].box.top), 3.0);
  ASSERT_TRUE(places[0].label);
  EXPECT_EQ(places[0].text, "1: 3 kHz");
  EXPECT_GT(places[0].label->bottom, places[0].box.top);
  EXPECT_FALSE(places[0].leader);
}

TEST(PlaceMarks, WhatDoesNotTouchTheMapIsLeftOutAndTheRestCut) {
  const auto places = place_marks({mark(-3.0, -1.0, 3000.0), mark(11.0, 12.0, 3000.0),
                                   mark(2.0, 3.0, 7000.0), mark(-1.0, 1.0, 5990.0)},
                                  map_of_ten_seconds());
  ASSERT_EQ(places.size(), 1u);
  EXPECT_EQ(places[0].mark, 3u);
  EXPECT_EQ(places[0].box.left, 0.0);
  EXPECT_EQ(places[0].box.top, 6.0);
  ASSERT_TRUE(places[0].label);  // below, because there is no room above
  EXPECT_LT(places[0].label->top, places[0].box.bottom);
}

TEST(PlaceMarks, NothingIsCoveredHoweverCrowded) {
  std::mt19937 generator(8);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<SpectrogramMark> marks;
    for (int i = 0; i < 12; ++i) {
      const double from = 10.0 * uniform(generator);
      marks.push_back(mark(from, from + uniform(generator), 6000.0 * uniform(generator)));
    }
    const auto places = place_marks(marks, map_of_ten_seconds());
    ASSERT_EQ(places.size(), 12u);
    for (const MarkPlace& place : places) {
      if (!place.label) continue;
      EXPECT_GE(place.label->left, 0.0);
      EXPECT_GE(place.label->bottom, 0.0);
      EXPECT_LE(place.label->right, 10.0 + 1e-9);
      EXPECT_LE(place.label->top, 6.0);
      for (const MarkPlace& other : places) {
        EXPECT_FALSE(overlap(*place.label, other.box));
        if (&place == &other) continue;
        if (other.label) {
          EXPECT_FALSE(overlap(*place.label, *other.label));
        }
        if (other.leader) {
          const PictureBox& line = *other.leader;
          EXPECT_FALSE(
              overlap(*place.label, {line.left - 0.01, line.right + 0.01, line.bottom, line.top}));
        }
      }
    }
  }
}

TEST(PlaceMarks, NeighboursWithWideLabelsBothGetThem) {
  // The bursts of a run: boxes side by side at one frequency, narrower than their labels.
  const auto places =
      place_marks({mark(6.86, 7.44, 3534.0), mark(7.78, 9.29, 3520.0), mark(9.33, 9.98, 3530.0)},
                  map_of_ten_seconds());
  for (const MarkPlace& place : places) EXPECT_EQ(place.text, "1: 3 kHz");
}

TEST(PlaceMarks, ShortLabelWhereThereIsNoRoomForTheLong) {
  MapArea map = map_of_ten_seconds();
  map.width = 1.0;
  const auto places = place_marks({mark(2.0, 5.0, 3000.0)}, map);
  EXPECT_EQ(places[0].text, "1");
  map.width = 0.1;
  EXPECT_FALSE(place_marks({mark(2.0, 5.0, 3000.0)}, map)[0].label);
}

TEST(PlaceMarks, LabelsMayBeLeftEmptyAndMomentsRemainVisible) {
  SpectrogramMark moment = mark(2.0, 2.0, 3000.0, "");
  moment.short_label.clear();
  const auto places = place_marks({moment}, map_of_ten_seconds());
  EXPECT_FALSE(places[0].label);
  EXPECT_GT(places[0].box.right - places[0].box.left, 0.1);
}

// ---------------------------------------------------------------- pictures

SpectrogramPicture picture_of_acceleration() {
  SpectrogramPicture picture;
  picture.title = "beam.end.y.acceleration";
  picture.units = "m/s^2";
  picture.max_frequency = 40000.0;
  picture.reference = 1e-6;
  picture.mean_lines = 2;
  picture.caption = "Hann window of 1 ms";
  return picture;
}

Spectrogram tone(std::size_t num_samples) {
  std::vector<double> samples(num_samples);
  for (std::size_t i = 0; i < num_samples; ++i)
    samples[i] = std::sin(2.0 * std::numbers::pi * 0.1 * static_cast<double>(i));
  return make_spectrogram(samples, 1e-5, {WindowKind::hann, 50, 0.5});
}

TEST(PlotSpectrogram, SaysWhatItShows) {
  const TemporaryFolder folder;
  SpectrogramPicture picture = picture_of_acceleration();
  picture.marks = {mark(1e-3, 2e-3, 10000.0, "1: 10 kHz"),
                   {2e-3, 3e-3, 20000.0, "71 1/s", "", MarkStyle::predicted}};
  plot_spectrogram(tone(500), picture, folder / "a.svg");
  const std::string svg = contents_of(folder / "a.svg");
  for (const char* text :
       {"amplitude (dB re 1 µm/s²)", "frequency (kHz)", "time (ms)", "beam.end.y.acceleration",
        "Hann window of 1 ms", "1: 10 kHz", "71 1/s", "<image"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
}

TEST(PlotSpectrogram, WritesTheShortLabelWhereThereIsNoRoomForTheLong) {
  const TemporaryFolder folder;
  SpectrogramPicture picture = picture_of_acceleration();
  const std::string wide(200, 'w');
  picture.marks = {{1e-3, 2e-3, 10000.0, wide, "17", MarkStyle::found}};
  plot_spectrogram(tone(500), picture, folder / "a.svg");
  const std::string svg = contents_of(folder / "a.svg");
  EXPECT_THAT(svg, HasSubstr(">17<"));
  // The caption says the whole of it, once.
  const auto caption = svg.find("Without room");
  const auto label = svg.find(wide);
  ASSERT_NE(caption, std::string::npos);
  ASSERT_NE(label, std::string::npos);
  EXPECT_GT(label, caption);
  EXPECT_EQ(svg.find(wide, label + 1), std::string::npos);
}

TEST(PlotSpectrogram, LongRunsMakeSmallFiles) {
  const TemporaryFolder folder;
  // 12,000 pieces of 26 lines: 312,000 amplitudes, as text alone 2 MB.
  plot_spectrogram(tone(300000), picture_of_acceleration(), folder / "a.pdf");
  EXPECT_THAT(contents_of(folder / "a.pdf"), StartsWith("%PDF"));
  EXPECT_LT(std::filesystem::file_size(folder / "a.pdf"), 300000u);
}

TEST(PlotSpectrogram, SilenceAndASinglePieceAreDrawn) {
  const TemporaryFolder folder;
  Spectrogram silence = tone(50);
  ASSERT_EQ(silence.times.size(), 1u);
  plot_spectrogram(silence, picture_of_acceleration(), folder / "piece.png");
  silence.amplitude.setZero();
  SpectrogramPicture bare = picture_of_acceleration();
  bare.title.clear();
  bare.caption.clear();
  plot_spectrogram(silence, bare, folder / "silence.png");
  EXPECT_GT(std::filesystem::file_size(folder / "silence.png"), 1000u);
}

TEST(PlotSpectrogram, RejectsWhatItCannotDraw) {
  const TemporaryFolder folder;
  const auto message = [&](const auto& change) {
    SpectrogramPicture picture = picture_of_acceleration();
    change(picture);
    return message_of<std::invalid_argument>(
        [&] { plot_spectrogram(tone(100), picture, folder / "a.svg"); });
  };
  EXPECT_THAT(message([](SpectrogramPicture& p) { p.reference = 0.0; }),
              HasSubstr("the reference must be positive"));
  EXPECT_THAT(message([](SpectrogramPicture& p) { p.range = -1.0; }),
              HasSubstr("the range must be positive"));
  EXPECT_THAT(message([](SpectrogramPicture& p) { p.max_frequency = 0.0; }),
              HasSubstr("the highest frequency must be positive"));
  EXPECT_THAT(message_of<ConfigError>([&] {
                plot_spectrogram(tone(100), picture_of_acceleration(), folder / "a.bmp");
              }),
              HasSubstr("must end with .png, .svg or .pdf"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

// ---------------------------------------------------------------- numbers

class Hdf5File {
 public:
  explicit Hdf5File(const std::filesystem::path& path)
      : id_(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT)) {}
  Hdf5File(const Hdf5File&) = delete;
  Hdf5File& operator=(const Hdf5File&) = delete;
  ~Hdf5File() { H5Fclose(id_); }

  std::vector<hsize_t> shape(const char* dataset) const {
    int rank = 0;
    H5LTget_dataset_ndims(id_, dataset, &rank);
    std::vector<hsize_t> sizes(static_cast<std::size_t>(rank));
    H5LTget_dataset_info(id_, dataset, sizes.data(), nullptr, nullptr);
    return sizes;
  }
  std::vector<double> values(const char* dataset) const {
    hsize_t count = 1;
    for (const hsize_t size : shape(dataset)) count *= size;
    std::vector<double> result(count);
    H5LTread_dataset_double(id_, dataset, result.data());
    return result;
  }
  std::string text(const char* dataset, const char* attribute) const {
    char buffer[200] = {};
    H5LTget_attribute_string(id_, dataset, attribute, buffer);
    return buffer;
  }
  double number(const char* attribute) const {
    double value = std::nan("");
    H5LTget_attribute_double(id_, "/", attribute, &value);
    return value;
  }
  bool is_scaled_by(const char* dataset, const char* scale, unsigned dimension) const {
    const hid_t data = H5Dopen2(id_, dataset, H5P_DEFAULT);
    const hid_t along = H5Dopen2(id_, scale, H5P_DEFAULT);
    const bool is_attached = H5DSis_attached(data, along, dimension) > 0;
    H5Dclose(along);
    H5Dclose(data);
    return is_attached;
  }

 private:
  hid_t id_;
};

TEST(SpectrogramFile, HoldsTheSpectrogramWithItsScales) {
  const TemporaryFolder folder;
  Spectrogram spectrogram = small_spectrogram(3, 2);
  spectrogram.amplitude << 1.0, 4.0, 2.0, 5.0, 3.0, 6.0;
  write_spectrogram_file((folder / "s.h5").string(), Overwrite::no, spectrogram, "m/s^2",
                         {{"window", "hann"}, {"length", 2.0}});
  const Hdf5File file(folder / "s.h5");
  EXPECT_THAT(file.shape("/amplitude"), ElementsAre(2, 3));
  EXPECT_THAT(file.values("/amplitude"), ElementsAre(1.0, 2.0, 3.0, 4.0, 5.0, 6.0));
  EXPECT_EQ(file.values("/times"), spectrogram.times);
  EXPECT_EQ(file.values("/frequencies"), spectrogram.frequencies);
  EXPECT_EQ(file.text("/amplitude", "units"), "m/s^2");
  EXPECT_EQ(file.text("/times", "units"), "s");
  EXPECT_EQ(file.text("/frequencies", "units"), "Hz");
  EXPECT_EQ(file.text("/", "window"), "hann");
  EXPECT_EQ(file.number("length"), 2.0);
  EXPECT_EQ(file.number("noise_bandwidth"), 0.75);
  EXPECT_TRUE(file.is_scaled_by("/amplitude", "/times", 0));
  EXPECT_TRUE(file.is_scaled_by("/amplitude", "/frequencies", 1));
}

TEST(SpectrogramFile, ExistingFileIsKeptUnlessAskedOrWhenItFails) {
  const TemporaryFolder folder;
  const std::string path = (folder / "s.h5").string();
  write_file(path, "old");
  const Spectrogram spectrogram = small_spectrogram(3, 2);
  EXPECT_THAT(message_of<FileError>(
                  [&] { write_spectrogram_file(path, Overwrite::no, spectrogram, "m", {}); }),
              HasSubstr("s.h5: exists; use --force to overwrite it"));
  // An attribute may have 64 KiB at most.
  EXPECT_THAT(message_of<FileError>([&] {
                write_spectrogram_file(path, Overwrite::yes, spectrogram, "m",
                                       {{"essay", std::string(70000, 'x')}});
              }),
              HasSubstr("cannot write attribute 'essay'"));
  EXPECT_EQ(contents_of(path), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
  write_spectrogram_file(path, Overwrite::yes, spectrogram, "m", {});
  EXPECT_THAT(Hdf5File(path).shape("/amplitude"), ElementsAre(2, 3));
  EXPECT_THAT(message_of<FileError>([&] {
                write_spectrogram_file((folder / "none" / "s.h5").string(), Overwrite::no,
                                       spectrogram, "m", {});
              }),
              HasSubstr("cannot be used"));
}

}  // namespace
}  // namespace stridor
