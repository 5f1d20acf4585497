// The processes that mpirun has started, and what they share.
#pragma once

#include <mpi.h>

#include <string>

#include "estimation/evaluation/load_case_share.h"

namespace hookeye {

/// MPI from here to end(). One a process; used by the thread that made it, while
/// no other calls MPI (MPI_THREAD_SERIALIZED).
class World : public LoadCaseShare {
 public:
  World(int& argc, char**& argv);
  int processes() const override { return processes_; }
  int self() const override { return self_; }
  int on_this_machine() const { return on_this_machine_; }
  void exchange(const std::vector<int>& owner, std::vector<Result*> results) override;
  /// Returns once all have come here.
  void meet();
  /// Ends MPI. Where another process does not come here within some seconds, having failed alone or
  /// waiting for this one, all are ended. `told`: what this process, if not the first, has to say
  /// then.
  int end(int status, const std::string& told);

 private:
  int processes_ = 1, self_ = 0, on_this_machine_ = 1;
  MPI_Comm endings_ = MPI_COMM_NULL;
};

}  // namespace hookeye
