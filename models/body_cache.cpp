#include "models/body_cache.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>

#include "core/errors.hpp"
#include "core/tasks.hpp"
#include "models/keys_text.hpp"
#include "substructures/bodies/whole_body.hpp"
#include "substructures/reduction/interface_modes.hpp"

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
  if (double* spin = undamped->own_spin()) *spin = 0.0;
  std::string text = fmt::format("{}{}{}:", undamped->type(), parameters.terms().rotation ? "" : "!",
                                 parameters.terms().damping ? "" : "~");
  append_keys(text, undamped->keys(), undamped->object());
  return text;
}

std::string key_of(const BodyCache::Wanted& wanted) {
  const std::string body = key_of(*wanted.parameters);
  if (wanted.is_whole) return fmt::format("{}|whole|{}", body, fmt::join(wanted.watched, ","));
  return fmt::format("{}|{}|{}|{}", body, fmt::join(wanted.interface, ","), wanted.num_modes,
                     fmt::join(wanted.watched, ","));
}

std::shared_ptr<const BodyCache::Reduction> make_reduction(const BodyCache::Wanted& wanted) {
  auto kept = std::make_shared<BodyCache::Reduction>();
  BodyCache::Reduction& made = *kept;
  made.reduced = wanted.is_whole ? make_whole(*wanted.body, wanted.watched)
                                 : make_craig_bampton(*wanted.body, wanted.interface,
                                                      wanted.num_modes, wanted.watched);
  if (wanted.interface_modes && !wanted.is_whole)
    made.reduced = with_interface_modes(made.reduced, *wanted.interface_modes);
  made.modal = make_modal(made.reduced);
  return kept;
}

}  // namespace

BodyCache::BodyCache(std::size_t capacity) : capacity_(capacity) {
  if (capacity == 0) throw std::invalid_argument("BodyCache: the capacity is 0");
}

template <class Content>
const Content* BodyCache::find(Store<Content>& store, const std::string& key) {
  for (Entry<Content>& entry : store) {
    if (entry.key != key) continue;
    entry.last_use = ++num_uses_;
    return entry.content.get();
  }
  return nullptr;
}

template <class Content>
const Content& BodyCache::keep(Store<Content>& store, std::string key,
                               std::shared_ptr<const Content> content) {
  if (store.size() >= capacity_) {
    store.erase(std::min_element(store.begin(), store.end(), [](const auto& a, const auto& b) {
      return a.last_use < b.last_use;
    }));
  }
  store.push_back({std::move(key), std::move(content), ++num_uses_});
  return *store.back().content;
}

BodyMatrices BodyCache::matrices(const BodyParameters& parameters) {
  const std::string key = key_of(parameters);
  const BodyMatrices* found = find(bodies_, key);
  if (found == nullptr)
    found = &keep(bodies_, key,
                  std::shared_ptr<const BodyMatrices>(new BodyMatrices(parameters.make())));
  BodyMatrices body = *found;
  if (const RayleighDamping* damping = parameters.own_damping()) body.damping = *damping;
  if (const double* spin = parameters.own_spin(); spin != nullptr && body.spin)
    body.spin->speed = *spin;
  return body;
}

BodyCache::Reduction BodyCache::reduce(const Wanted& wanted) {
  const std::string key = key_of(wanted);
  const Reduction* found = find(reductions_, key);
  if (found == nullptr) {
    found = &keep(reductions_, key, make_reduction(wanted));
    ++num_reductions_;
  }
  Reduction copied = *found;
  copied.reduced.damping = wanted.body->damping;
  copied.modal.damping = wanted.body->damping;
  if (copied.reduced.spin) {
    const CoupledTerms terms =
        spin_terms(*copied.reduced.spin, wanted.body->spin->speed, wanted.body->damping);
    add_terms(terms.in(copied.modal.shapes), copied.modal.coupled);
    add_terms(terms, copied.reduced.coupled);
    copied.reduced.spin.reset();
  }
  return copied;
}

void BodyCache::prepare(std::span<const Wanted> wanted) {
  std::map<std::string, const Wanted*> missing;
  for (const Wanted& one : wanted) {
    const std::string key = key_of(one);
    if (find(reductions_, key) == nullptr) missing.emplace(key, &one);
  }
  if (missing.size() < 2 || missing.size() > capacity_) return;
  const std::vector<std::pair<std::string, const Wanted*>> tasks(missing.begin(), missing.end());
  std::vector<std::shared_ptr<const Reduction>> made(tasks.size());
  run_tasks(
      tasks.size(), static_cast<int>(std::thread::hardware_concurrency()),
      [&](std::size_t task, std::size_t) {
        try {
          made[task] = make_reduction(*tasks[task].second);
        } catch (const NumericalError&) {  // reduce() meets it again and says of which body
        } catch (const std::invalid_argument&) {
        }
      },
      [](std::size_t, std::size_t) {});
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (!made[i]) continue;
    keep(reductions_, tasks[i].first, std::move(made[i]));
    ++num_reductions_;
  }
}

}  // namespace stridor
