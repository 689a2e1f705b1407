#include "io/scene/scene_sections.hpp"

namespace stridor {

const Schema& RecordParameters::schema() {
  static const Schema keys =
      SchemaOf<RecordParameters>("record")
          .real("interval", &RecordParameters::interval,
                {.doc = "Time between recorded samples; a whole multiple of time.step. Motions are "
                        "low-passed before they are thinned to it; contact forces and states are "
                        "not. Of the integrator event_driven everything is taken at that instant.",
                 .unit = "s",
                 .range = Range::positive()})
          .text_list(
              "channels", &RecordParameters::channels,
              {.doc =
                   "What is recorded: <body>.<point>.<x|y|z>.<displacement|velocity|acceleration>, "
                   "<contact>.<force|gap|slip_velocity|position|friction_force|state|area|friction_across|"
                   "slip_across>."})
          .flag("energy", &RecordParameters::energy,
                {.doc = "Whether the energy ledger is kept and recorded under /energy; a step then "
                        "costs about two and a half times as much.",
                 .optional = true});
  return keys;
}

const Schema& MeasureParameters::schema() {
  static const Schema keys =
      SchemaOf<MeasureParameters>("measure")
          .real("from", &MeasureParameters::from,
                {.doc = "Start of the window of the statistics.",
                 .unit = "s",
                 .range = Range::non_negative(),
                 .optional = true})
          .real("to", &MeasureParameters::to,
                {.doc = "End of the window of the statistics; default: end of the run.",
                 .unit = "s",
                 .range = Range::positive(),
                 .optional = true})
          .real_list("band", &MeasureParameters::band,
                     {.doc = "Band of the r.m.s. values, and in which bursts are sought: lower and "
                             "upper frequency; default: all frequencies, and no bursts.",
                      .unit = "Hz",
                      .range = Range::positive(),
                      .optional = true})
          .check([](const MeasureParameters& measure, std::vector<Problem>& problems) {
            if (!measure.band.empty() &&
                (measure.band.size() != 2 || measure.band[0] >= measure.band[1])) {
              problems.push_back(
                  {Refusal::wrong_size, "band", "must be two frequencies, the lower one first"});
            }
            if (measure.to && *measure.to <= measure.from)
              problems.push_back({Refusal::wrong_value, "to", "must be later than `from`"});
          });
  return keys;
}

const Schema& CycleParameters::schema() {
  static const Schema keys = SchemaOf<CycleParameters>("cycle").real(
      "settle", &CycleParameters::settle,
      {.doc = "Time that passes before the motion is taken for settled.",
       .unit = "s",
       .range = Range::positive()});
  return keys;
}

const Schema& SpectrogramSection::schema() {
  static const Schema keys =
      SchemaOf<SpectrogramSection>("spectrogram")
          .text("channel", &SpectrogramSection::channel,
                {.doc = "Which recorded channel; default: the acceleration in which bursts are "
                        "sought.",
                 .optional = true})
          .choice("window", &SpectrogramSection::window, window_names(),
                  {.doc = "Weights of the pieces that are transformed.", .optional = true})
          .real("length", &SpectrogramSection::length,
                {.doc = "Duration of a piece; default: (duration/max_frequency)^1/2, with which "
                        "the picture has as many lines as columns without overlap.",
                 .unit = "s",
                 .range = Range::positive(),
                 .optional = true})
          .real("overlap", &SpectrogramSection::overlap,
                {.doc = "Part of a piece that it shares with the next.",
                 .range = {0.0, 1.0, false, true},
                 .optional = true})
          .real("max_frequency", &SpectrogramSection::max_frequency,
                {.doc = "End of the frequency axis; default: upper end of measure.band, else "
                        "0.4/record.interval.",
                 .unit = "Hz",
                 .range = Range::positive(),
                 .optional = true});
  return keys;
}

const Schema& CheckpointParameters::schema() {
  static const Schema keys =
      SchemaOf<CheckpointParameters>("checkpoint")
          .real("every", &CheckpointParameters::every,
                {.doc = "Wall time between two checkpoints in the run file; `run --resume` goes on "
                        "from the latest.",
                 .unit = "s",
                 .range = Range::positive(),
                 .optional = true});
  return keys;
}

const Schema& Expectation::schema() {
  static const Schema keys =
      SchemaOf<Expectation>("expect")
          .text("result", &Expectation::result,
                {.doc = "Path of the number in the JSON object of `run` or `contact`, e.g. "
                        "contact_force.min or rows.0.force."})
          .real("value", &Expectation::value, {.doc = "What it should be, SI."})
          .real("tolerance", &Expectation::tolerance,
                {.doc = "Largest allowed absolute difference.", .range = Range::non_negative()});
  return keys;
}

}  // namespace stridor
