#include "io/figures/modal_test_plot.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <stdexcept>
#include <utility>
#include <vector>

#include "substructures/elements/mesh.hpp"

namespace stridor {
namespace {

/// Numbers of the nodes of a list; it ends where one has no place.
std::vector<std::vector<int>> placed_pieces(const std::vector<std::int64_t>& labels,
                                            const std::map<std::int64_t, int>& numbers) {
  std::vector<std::vector<int>> pieces(1);
  for (const std::int64_t label : labels) {
    const auto number = numbers.find(label);
    if (number == numbers.end())
      pieces.emplace_back();
    else
      pieces.back().push_back(number->second);
  }
  std::erase_if(pieces, [](const std::vector<int>& piece) { return piece.size() < 2; });
  return pieces;
}

}  // namespace

MeshPicture modal_test_picture(const ModalTest& test, const std::string& caption) {
  if (test.nodes.empty()) throw std::invalid_argument("modal_test_picture: there are no nodes");
  PicturePart part;
  part.colour = part_colour(0);
  part.nodes.resize(static_cast<Eigen::Index>(test.nodes.size()), 3);
  std::map<std::int64_t, int> numbers;
  for (const auto& [label, place] : test.nodes) {
    const auto number = static_cast<int>(numbers.size());
    part.nodes.row(number) = place.transpose();
    numbers.emplace(label, number);
  }
  for (const std::vector<std::int64_t>& line : test.lines)
    for (std::vector<int>& piece : placed_pieces(line, numbers))
      part.lines.push_back(std::move(piece));
  std::vector<DrawnElement> elements;
  bool is_closed = !test.elements.empty();
  for (const TestElement& element : test.elements) {
    DrawnElement drawn{element.shape, {}};
    for (const std::int64_t label : element.nodes)
      if (const auto number = numbers.find(label); number != numbers.end())
        drawn.nodes.push_back(number->second);
    if (drawn.nodes.size() != element.nodes.size()) continue;
    is_closed = is_closed && facts_of(element.shape).dimension == 3;
    elements.push_back(std::move(drawn));
  }
  part.faces = face_loops(elements);
  part.is_closed = is_closed;
  MeshPicture picture;
  const Eigen::RowVector3d extent =
      part.nodes.colwise().maxCoeff() - part.nodes.colwise().minCoeff();
  picture.view =
      extent.z() <= 1e-9 * extent.norm() ? PictureView::plane() : PictureView::isometric();
  constexpr Eigen::Index most_dots = 400;
  for (Eigen::Index i = 0; i < part.nodes.rows() && part.nodes.rows() <= most_dots; ++i)
    picture.places.push_back({part.nodes.row(i).transpose(), PictureMark::mass});
  picture.parts.push_back(std::move(part));
  picture.caption = caption;
  return picture;
}

}  // namespace stridor
