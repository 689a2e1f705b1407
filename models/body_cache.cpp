#include "models/body_cache.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <stdexcept>

#include "models/keys_text.hpp"
#include "substructures/bodies/whole_body.hpp"

namespace stridor {
namespace {

void append(std::string& text, const Value& value) {
  const auto write = [&](const auto& content) {
    using Content = std::decay_t<decltype(content)>;
    if constexpr (std::is_same_v<Content, std::monostate>) {
      text += '-';
    } else if constexpr (std::is_same_v<Content, TimeTable>) {
      text += fmt::format("{} {}", content.times, content.values);
    } else if constexpr (std::is_same_v<Content, std::vector<std::string>>) {
      // Rows of matrices may be long: copied as they are, with their lengths.
      for (const std::string& line : content) {
        text += std::to_string(line.size());
        text += ' ';
        text += line;
      }
    } else if constexpr (std::is_same_v<Content, NamedNumbers>) {
      // Keys that depend on parameters hold values.
    } else {
      text += fmt::format("{}", content);
    }
  };
  std::visit(write, value);
}

/// The keys of a struct and what they hold, in the order of their declaration.
void append_keys(std::string& text, const Schema& schema, const void* object) {
  for (const Key& key : schema.keys) {
    text += key.name + '=';
    if (key.read) append(text, key.read(object));
    if (key.visit) {
      key.visit(object, [&](const std::string& name, std::size_t alternative, const void* entry) {
        text += name + '{';
        append_keys(text, key.alternatives[alternative].schema(), entry);
        text += '}';
      });
    }
    text += ';';
  }
}

}  // namespace

std::string keys_text(const Schema& schema, const void* object) {
  std::string text;
  append_keys(text, schema, object);
  return text;
}

namespace {

/// What is the same for two bodies that differ at most in their damping.
std::string key_of(const BodyParameters& parameters) {
  const std::unique_ptr<BodyParameters> undamped = parameters.clone();
  if (RayleighDamping* damping = undamped->own_damping()) *damping = {};
  std::string text = fmt::format("{}{}{}:", undamped->type(), parameters.terms().rotation ? "" : "!",
                                 parameters.terms().damping ? "" : "~");
  append_keys(text, undamped->keys(), undamped->object());
  return text;
}

}  // namespace

BodyCache::BodyCache(std::size_t capacity) : capacity_(capacity) {
  if (capacity == 0) throw std::invalid_argument("BodyCache: the capacity is 0");
}

template <class Content>
Content* BodyCache::find(Store<Content>& store, const std::string& key) {
  for (Entry<Content>& entry : store) {
    if (entry.key != key) continue;
    entry.last_use = ++num_uses_;
    return &entry.content;
  }
  return nullptr;
}

template <class Content>
Content& BodyCache::keep(Store<Content>& store, std::string key, Content content) {
  if (store.size() >= capacity_) {
    store.erase(std::min_element(store.begin(), store.end(), [](const auto& a, const auto& b) {
      return a.last_use < b.last_use;
    }));
  }
  store.push_back({std::move(key), std::move(content), ++num_uses_});
  return store.back().content;
}

BodyMatrices BodyCache::matrices(const BodyParameters& parameters) {
  const std::string key = key_of(parameters);
  const BodyMatrices* found = find(bodies_, key);
  if (found == nullptr) found = &keep(bodies_, key, parameters.make());
  BodyMatrices body = *found;
  if (const RayleighDamping* damping = parameters.own_damping()) body.damping = *damping;
  return body;
}

template <class Make>
BodyCache::Reduction BodyCache::reduction(const std::string& key, const BodyMatrices& body,
                                          const Make& make) {
  const Reduction* found = find(reductions_, key);
  if (found == nullptr) {
    Reduction made;
    made.reduced = make();
    made.modal = make_modal(made.reduced);
    ++num_reductions_;
    found = &keep(reductions_, key, std::move(made));
  }
  Reduction copied = *found;
  copied.reduced.damping = body.damping;
  copied.modal.damping = body.damping;
  return copied;
}

BodyCache::Reduction BodyCache::reduce(const BodyParameters& parameters,
                                       const BodyMatrices& body, std::span<const int> interface,
                                       Eigen::Index num_modes, std::span<const int> watched) {
  const std::string key = fmt::format("{}|{}|{}|{}", key_of(parameters), fmt::join(interface, ","),
                                      num_modes, fmt::join(watched, ","));
  return reduction(key, body,
                   [&] { return make_craig_bampton(body, interface, num_modes, watched); });
}

BodyCache::Reduction BodyCache::keep_whole(const BodyParameters& parameters,
                                           const BodyMatrices& body,
                                           std::span<const int> watched) {
  return reduction(fmt::format("{}|whole|{}", key_of(parameters), fmt::join(watched, ",")), body,
                   [&] { return make_whole(body, watched); });
}

}  // namespace stridor
