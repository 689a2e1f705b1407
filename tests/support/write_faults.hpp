// Deaths and full disks at a chosen call of the system.
#pragma once

namespace stridor::test {

enum class Fault {
  none,
  kill,           ///< the process dies before the call
  torn,           ///< it dies in the midst of the call, after the first page of a write
  no_space,       ///< this call fails with ENOSPC, those after it do not
  full,           ///< all calls from this one on fail
  no_space_kill,  ///< this call fails, and a later one kills
};

/// Faults of the calls that write files: write, pwrite, ftruncate, posix_fallocate, rename,
/// renameat2, fsync and unlink, of regular files other than the standard streams.
struct FaultPlan {
  Fault fault = Fault::none;
  long at = 0;     ///< number of the call, from 1 on
  long death = 0;  ///< of no_space_kill
  long count = 0;  ///< calls so far
};

/// The plan in force; null: none. In memory that a child shares with its parent, so that the count
/// outlives it.
extern FaultPlan* fault_plan;

}  // namespace stridor::test
