#include "core/tasks.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "core/blas.hpp"
#include "core/errors.hpp"
#include "core/memory.hpp"
#include "core/stop_token.hpp"

namespace stridor {

namespace {

/// Whether this thread works on tasks beside others, all of which keep the machine busy already.
thread_local bool is_working = false;

}  // namespace

void run_tasks(std::size_t count, int num_threads,
               const std::function<void(std::size_t task, std::size_t thread)>& work,
               const std::function<void(std::size_t num_done, std::size_t task)>& done) {
  std::atomic<std::size_t> next{0};
  std::size_t num_done = 0;
  std::exception_ptr failure;
  std::size_t failed_task = count;
  std::mutex telling;
  const bool is_nested = is_working;
  const auto take_tasks = [&](std::size_t thread) {
    for (std::size_t task = next++; task < count && !stop_requested(); task = next++) {
      try {
        work(task, thread);
        const std::lock_guard lock(telling);
        done(++num_done, task);
      } catch (...) {
        const std::lock_guard lock(telling);
        if (task < failed_task) {
          failure = std::current_exception();
          failed_task = task;
        }
        next = count;
        return;
      }
    }
  };
  std::vector<std::thread> threads;
  const std::size_t num_used =
      is_nested ? 1 : std::min(count, static_cast<std::size_t>(std::max(num_threads, 1)));
  if (num_used > 1) keep_freed_memory();
  for (std::size_t i = 1; i < num_used; ++i) {
    threads.emplace_back([&take_tasks, i] {
      keep_blas_in_this_thread();
      is_working = true;
      take_tasks(i);
    });
  }
  is_working = is_nested || num_used > 1;
  take_tasks(0);
  is_working = is_nested;
  for (std::thread& thread : threads) thread.join();
  if (failure) std::rethrow_exception(failure);
  if (stop_requested()) throw Interrupted("nothing has been written");
}

}  // namespace stridor
