#include "app/mpi/world.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <thread>

#include "estimation/evaluation/load_case_bytes.h"

namespace hookeye {

namespace {

/// Bytes of `owner` reach all others. MPI counts in int: in pieces.
void send_from(int owner, std::string& bytes) {
  std::uint64_t size = bytes.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, owner, MPI_COMM_WORLD);
  bytes.resize(size);
  constexpr std::uint64_t kPiece = std::uint64_t{1} << 28;
  for (std::uint64_t at = 0; at < size; at += kPiece)
    MPI_Bcast(bytes.data() + at, static_cast<int>(std::min(kPiece, size - at)), MPI_BYTE, owner,
              MPI_COMM_WORLD);
}

}  // namespace

World::World(int& argc, char**& argv) {
  int provided = 0;
  // PETSc computes on whatever thread has a load case, one at a time (simulation/petsc).
  MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &provided);
  if (provided < MPI_THREAD_SERIALIZED)
    throw std::runtime_error("this MPI serves one thread only (MPI_THREAD_SERIALIZED is needed)");
  MPI_Comm_size(MPI_COMM_WORLD, &processes_);
  MPI_Comm_rank(MPI_COMM_WORLD, &self_);
  MPI_Comm_dup(MPI_COMM_WORLD, &endings_);
  MPI_Comm here = MPI_COMM_NULL;
  MPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, self_, MPI_INFO_NULL, &here);
  MPI_Comm_size(here, &on_this_machine_);
  MPI_Comm_free(&here);
}

void World::exchange(const std::vector<int>& owner, std::vector<Result*> results) {
  if (processes_ == 1) return;
  for (size_t i = 0; i < results.size(); ++i) {
    std::string bytes;
    if (owner[i] == self_) bytes = to_bytes(*results[i]);
    send_from(owner[i], bytes);
    if (owner[i] != self_) *results[i] = from_bytes(bytes);
  }
}

void World::meet() { MPI_Barrier(MPI_COMM_WORLD); }

int World::end(int status, const std::string& told) {
  // Whoever fails as the first one does leaves the telling to that one.
  const auto patience = std::chrono::seconds(self_ == 0 ? 5 : 8);
  const auto end = std::chrono::steady_clock::now() + patience;
  MPI_Request all = MPI_REQUEST_NULL;
  MPI_Ibarrier(endings_, &all);
  int here = 0;
  for (;;) {
    MPI_Test(&all, &here, MPI_STATUS_IGNORE);
    // after a success the others are on their way: the first may have a page to write
    if (here || (status != 0 && std::chrono::steady_clock::now() > end)) break;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  if (!here) {
    if (self_ != 0)
      fmt::print(stderr, "process {} of {} ended alone:\n{}\n", self_ + 1, processes_, told);
    std::fflush(nullptr);
    MPI_Abort(MPI_COMM_WORLD, status);
  }
  MPI_Comm_free(&endings_);
  MPI_Finalize();
  return status;
}

}  // namespace hookeye
