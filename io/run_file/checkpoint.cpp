#include "io/run_file/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <string>
#include <type_traits>

#include "core/checksum.hpp"

namespace stridor {
namespace {

constexpr std::array<unsigned char, 8> mark{'s', 't', 'r', 'i', 'd', 'o', 'r', 'C'};
/// mark, number of bytes that follow the head, their checksum
constexpr std::size_t head_size = mark.size() + 2 * sizeof(std::uint64_t);

class Packer {
 public:
  void add(const void* data, std::size_t size) {
    const auto* from = static_cast<const unsigned char*>(data);
    bytes_.insert(bytes_.end(), from, from + size);
  }
  void add(std::uint64_t number) { add(&number, sizeof number); }
  const std::vector<unsigned char>& bytes() const { return bytes_; }

 private:
  std::vector<unsigned char> bytes_;
};

/// Reads the bytes of a Packer; every size is checked against the bytes that are left.
class Unpacker {
 public:
  explicit Unpacker(std::span<const unsigned char> bytes) : rest_(bytes) {}

  bool take(void* target, std::size_t size) {
    if (size > rest_.size()) return false;
    if (size > 0) std::memcpy(target, rest_.data(), size);
    rest_ = rest_.subspan(size);
    return true;
  }
  bool take(std::uint64_t& number) { return take(&number, sizeof number); }
  template <class Sequence>
  bool take_sequence(Sequence& sequence) {
    using Entry = typename Sequence::value_type;
    std::uint64_t count = 0;
    if (!take(count) || count > rest_.size() / sizeof(Entry)) return false;
    sequence.resize(count);
    return take(sequence.data(), count * sizeof(Entry));
  }
  std::span<const unsigned char> rest() const { return rest_; }

 private:
  std::span<const unsigned char> rest_;
};

}  // namespace

std::vector<unsigned char> encode(const Checkpoint& checkpoint) {
  Packer content;
  content.add(checkpoint.number);
  content.add(checkpoint.rows);
  content.add(checkpoint.state.arrays().size());
  for (const auto& [name, values] : checkpoint.state.arrays()) {
    content.add(name.size());
    content.add(name.data(), name.size());
    content.add(values.size());
    content.add(values.data(), values.size() * sizeof(double));
  }
  Packer whole;
  whole.add(mark.data(), mark.size());
  whole.add(content.bytes().size());
  whole.add(fnv1a(content.bytes()));
  whole.add(content.bytes().data(), content.bytes().size());
  return whole.bytes();
}

std::optional<Checkpoint> decode(std::span<const unsigned char> bytes) {
  if (bytes.size() < head_size || !std::equal(mark.begin(), mark.end(), bytes.begin())) return {};
  Unpacker head(bytes.subspan(mark.size()));
  std::uint64_t size = 0;
  std::uint64_t sum = 0;
  if (!head.take(size) || !head.take(sum) || size > head.rest().size()) return {};
  const auto payload = head.rest().first(size);
  if (fnv1a(payload) != sum) return {};

  Unpacker content(payload);
  Checkpoint checkpoint;
  std::uint64_t num_arrays = 0;
  if (!content.take(checkpoint.number) || !content.take(checkpoint.rows) ||
      !content.take(num_arrays))
    return {};
  for (std::uint64_t i = 0; i < num_arrays; ++i) {
    std::string name;
    std::vector<double> values;
    if (!content.take_sequence(name) || !content.take_sequence(values)) return {};
    checkpoint.state.put(name, values);
  }
  return checkpoint;
}

}  // namespace stridor
