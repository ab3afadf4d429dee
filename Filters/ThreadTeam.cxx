// SPDX-License-Identifier: BSD-3-Clause
#include "ThreadTeam.h"

#include <algorithm>
#include <system_error>

//------------------------------------------------------------------------------
ThreadTeam::ThreadTeam(int numberOfThreads)
{
  try
  {
    for (int i = 1; i < numberOfThreads; ++i)
    {
      this->Helpers.emplace_back([this] { this->Help(); });
    }
  }
  catch (const std::system_error&)
  {
    // Fewer do the same.
  }
}

//------------------------------------------------------------------------------
ThreadTeam::~ThreadTeam()
{
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->IsOver = true;
  }
  this->Begun.notify_all();
  for (std::thread& helper : this->Helpers)
  {
    helper.join();
  }
}

//------------------------------------------------------------------------------
void ThreadTeam::Help()
{
  unsigned last = 0;
  std::unique_lock<std::mutex> lock(this->Mutex);
  for (;;)
  {
    this->Begun.wait(lock, [&] { return this->IsOver || (this->IsOpen && this->Turn != last); });
    if (this->IsOver)
    {
      return;
    }
    last = this->Turn;
    ++this->NumberInside;
    lock.unlock();
    this->Work();
    lock.lock();
    if (--this->NumberInside == 0)
    {
      this->Left.notify_one();
    }
  }
}

//------------------------------------------------------------------------------
void ThreadTeam::Work()
{
  for (size_t begin; (begin = this->Next.fetch_add(this->Grain)) < this->Count;)
  {
    this->Body(this->Data, begin, std::min(begin + this->Grain, this->Count));
  }
}

//------------------------------------------------------------------------------
void ThreadTeam::For(size_t count, size_t grain, void (*body)(void* data, size_t begin, size_t end), void* data)
{
  if (count <= grain || this->Helpers.empty())
  {
    body(data, 0, count);
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(this->Mutex);
    this->Next = 0;
    this->Count = count;
    this->Grain = grain;
    this->Body = body;
    this->Data = data;
    this->IsOpen = true;
    ++this->Turn;
  }
  this->Begun.notify_all();
  this->Work();
  // Not to wait for helpers that have not come in by now: there is nothing left for them to do.
  std::unique_lock<std::mutex> lock(this->Mutex);
  this->IsOpen = false;
  this->Left.wait(lock, [this] { return this->NumberInside == 0; });
}
