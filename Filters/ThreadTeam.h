// SPDX-License-Identifier: BSD-3-Clause
// Threads that share out loops. vtkSMPTools starts new ones for every loop, which costs as much as many of the kernels'
// loops take: these stay for a run of the kernels.
#ifndef ThreadTeam_h
#define ThreadTeam_h

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <mutex>
#include <thread>
#include <vector>

class ThreadTeam
{
public:
  // The calling thread is one of them.
  explicit ThreadTeam(int numberOfThreads);
  ~ThreadTeam();
  ThreadTeam(const ThreadTeam&) = delete;
  ThreadTeam& operator=(const ThreadTeam&) = delete;

  // Calls body(data, begin, end) over ranges of `grain` elements that cover [0, count).
  void For(size_t count, size_t grain, void (*body)(void* data, size_t begin, size_t end), void* data);

private:
  void Help();
  void Work();

  std::vector<std::thread> Helpers;
  std::mutex Mutex;
  std::condition_variable Begun, Left;
  unsigned Turn = 0;       // of the loops so far
  bool IsOpen = false;     // helpers may still join in the loop
  bool IsOver = false;     // of the team
  size_t NumberInside = 0; // helpers in the loop

  std::atomic<size_t> Next{ 0 };
  size_t Count = 0, Grain = 1;
  void (*Body)(void*, size_t, size_t) = nullptr;
  void* Data = nullptr;
};

#endif
