// Independent tasks on several threads.
#pragma once

#include <cstddef>
#include <functional>

namespace stridor {

/// Does tasks 0 … count − 1, each once, on several threads. Which thread does a task must not
/// affect its result.
///
/// Called from within a task it uses one thread: the others are busy.
///
/// @param work gets the task and the number of the thread, from 0
/// @param done called after every task, one at a time, with how many are done
/// @throws the exception of the first task in order that has thrown, whatever the threads do, once
///         the tasks that had begun are done; Interrupted where a stop was requested
void run_tasks(std::size_t count, int num_threads,
               const std::function<void(std::size_t task, std::size_t thread)>& work,
               const std::function<void(std::size_t num_done, std::size_t task)>& done);

}  // namespace stridor
