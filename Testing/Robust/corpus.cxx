// SPDX-License-Identifier: BSD-3-Clause
// Runs the filter on every surface of a folder with several sets of parameters, each in a process of its own under a
// limit of time and memory, and judges what comes out with code of its own. One line a file, then a summary.
//
// usage: corpus FOLDER [SECONDS [MEGABYTES]]
#include "Files.h"
#include "judge.h"

#include "vtkAnisotropicQuadRemesher.h"
#include "vtkCallbackCommand.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkNew.h"
#include "vtkPoints.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <string>
#include <vector>

namespace
{
enum Outcome
{
  DONE,
  REFUSED,
  CRASHED,
  HUNG,
  INVALID,
  OUTCOMES
};
const std::array<const char*, OUTCOMES> Names = { "done", "refused", "crashed", "hung", "invalid" };

struct Set
{
  const char* Name;
  void (*Apply)(vtkAnisotropicQuadRemesher*, vtkPolyData*);
};

// Adds lines along a side of every seventh polygon.
void AddLines(vtkPolyData* surface)
{
  vtkNew<vtkCellArray> lines;
  vtkNew<vtkIdList> ids;
  for (vtkIdType i = 0; i < surface->GetNumberOfPolys(); i += 7)
  {
    surface->GetPolys()->GetCellAtId(i, ids);
    if (ids->GetNumberOfIds() > 1)
    {
      lines->InsertNextCell(2, ids->GetPointer(0));
    }
  }
  surface->GetCellData()->Initialize(); // has no values for them
  surface->SetLines(lines);
}

// The surface comes out in the precision of the input: a float would not say what lies on a plane far from the origin.
void MakeDouble(vtkPolyData* surface)
{
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->DeepCopy(surface->GetPoints());
  surface->SetPoints(points);
}

const std::array<Set, 6> Sets = { {
  { "default", [](vtkAnisotropicQuadRemesher*, vtkPolyData*) {} },
  { "few points",
    [](vtkAnisotropicQuadRemesher* f, vtkPolyData*)
    {
      f->SetDensityModeToNumberOfPoints();
      f->SetTargetNumberOfPoints(100);
      f->FeatureLinesOff();
    } },
  { "coarse",
    [](vtkAnisotropicQuadRemesher* f, vtkPolyData*)
    {
      f->SetTolerance(0.02);
      f->SetLargestSpacing(0.3);
      f->BoundaryLinesOff();
      f->ConvexPartitionOff();
      f->SetFeatureAngle(15);
    } },
  { "pure quads",
    [](vtkAnisotropicQuadRemesher* f, vtkPolyData*)
    {
      f->SetDensityModeToNumberOfPoints();
      f->SetTargetNumberOfPoints(400);
      f->PureQuadsOn();
      f->SetAnisotropy(0.3);
      f->SetAdaptivity(0.3);
    } },
  { "symmetry",
    [](vtkAnisotropicQuadRemesher* f, vtkPolyData* surface)
    {
      MakeDouble(surface);
      f->SymmetryOn();
      f->SetSymmetryOrigin(surface->GetCenter());
      f->SetDensityModeToNumberOfPoints();
      f->SetTargetNumberOfPoints(300);
    } },
  { "locked lines",
    [](vtkAnisotropicQuadRemesher* f, vtkPolyData* surface)
    {
      AddLines(surface);
      f->LockLinesOn();
      f->SetDensityModeToNumberOfPoints();
      f->SetTargetNumberOfPoints(300);
    } },
} };

//------------------------------------------------------------------------------
struct Mesh
{
  explicit Mesh(vtkPolyData* data)
  {
    this->Points.resize(static_cast<size_t>(3 * data->GetNumberOfPoints()));
    for (vtkIdType i = 0; i < data->GetNumberOfPoints(); ++i)
    {
      data->GetPoint(i, this->Points.data() + 3 * i);
    }
    vtkNew<vtkIdList> ids;
    for (vtkIdType i = 0; i < data->GetNumberOfPolys(); ++i)
    {
      data->GetPolys()->GetCellAtId(i, ids);
      this->Connectivity.insert(this->Connectivity.end(), ids->begin(), ids->end());
      this->Offsets.push_back(static_cast<int64_t>(this->Connectivity.size()));
    }
  }
  verdict Judge() const
  {
    return judge_mesh(this->Points.size() / 3, this->Points.data(), this->Offsets.size() - 1, this->Offsets.data(),
      this->Connectivity.data());
  }
  // With its mirror image, as port 1 has the positive side only.
  verdict JudgeMirrored(vtkAnisotropicQuadRemesher* filter) const
  {
    judge_plane plane;
    std::copy_n(filter->GetSymmetryOrigin(), 3, plane.origin);
    std::copy_n(filter->GetSymmetryNormal(), 3, plane.normal);
    return judge_mirrored(this->Points.size() / 3, this->Points.data(), this->Offsets.size() - 1, this->Offsets.data(),
      this->Connectivity.data(), &plane);
  }
  std::vector<double> Points;
  std::vector<int64_t> Offsets = { 0 }, Connectivity;
};

//------------------------------------------------------------------------------
// What the child says before it ends: the outcome is its exit status, the words go to the parent.
int Run(const std::string& file, const Set& set, int words)
{
  std::string said;
  Outcome outcome = DONE;
  Complaints complaints;
  try
  {
    const auto surface = ReadSurface(file, complaints);
    vtkNew<vtkAnisotropicQuadRemesher> filter;
    filter->SetInputData(surface);
    filter->SetNumberOfThreads(1);
    set.Apply(filter, surface);
    filter->Update();
    const std::string error = complaints.TakeError();
    if (!error.empty() || filter->GetErrorCode() != 0)
    {
      said = error;
      outcome = error.empty() || error.find("defect") != std::string::npos ? INVALID : REFUSED;
      if (filter->GetOutput(0)->GetNumberOfPoints() != 0)
      {
        outcome = INVALID;
      }
    }
    else
    {
      const Mesh surfaceMesh(filter->GetOutput(1));
      const verdict repaired = filter->GetSymmetry() ? surfaceMesh.JudgeMirrored(filter) : surfaceMesh.Judge();
      const verdict remeshed = Mesh(filter->GetOutput(0)).Judge();
      const char* fault = judge_pair(&repaired, &remeshed);
      // the two sides may stay open where points are few, as long as it is said
      const bool lost = filter->GetSymmetry() && !repaired.fault && !remeshed.fault &&
                        std::string(filter->GetReport()).find("\"topology_lost\": 1") != std::string::npos;
      outcome = fault && !lost ? INVALID : DONE;
      said = lost ? "topology lost" : fault ? fault : "";
    }
  }
  catch (const FileError& failure)
  {
    said = failure.what();
    outcome = REFUSED;
  }
  catch (const std::bad_alloc&)
  {
    said = "out of memory";
    outcome = REFUSED;
  }
  const ssize_t written = write(words, said.data(), std::min<size_t>(said.size(), 400));
  _exit(written < 0 ? static_cast<int>(CRASHED) : static_cast<int>(outcome));
}

//------------------------------------------------------------------------------
Outcome RunApart(const std::string& file, const Set& set, rlim_t seconds, rlim_t megabytes, std::string& said)
{
  int ends[2];
  if (pipe(ends) != 0)
  {
    return CRASHED;
  }
  const pid_t child = fork();
  if (child == 0)
  {
    const rlimit time = { seconds, seconds + 1 };
    const rlimit memory = { megabytes << 20, megabytes << 20 };
    const rlimit core = { 0, 0 };
    setrlimit(RLIMIT_CPU, &time);
    setrlimit(RLIMIT_AS, &memory);
    setrlimit(RLIMIT_CORE, &core);
    Run(file, set, ends[1]);
  }
  close(ends[1]);
  char buffer[400];
  for (ssize_t n; (n = read(ends[0], buffer, sizeof buffer)) > 0;)
  {
    said.append(buffer, static_cast<size_t>(n));
  }
  close(ends[0]);
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) < 0)
  {
    return CRASHED;
  }
  if (WIFSIGNALED(status))
  {
    said = "signal " + std::to_string(WTERMSIG(status));
    return WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL ? HUNG : CRASHED;
  }
  return static_cast<Outcome>(std::min(WEXITSTATUS(status), static_cast<int>(INVALID)));
}

double ChildSeconds()
{
  rusage usage = {};
  getrusage(RUSAGE_CHILDREN, &usage);
  return static_cast<double>(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
}
}

//------------------------------------------------------------------------------
int main(int argc, char* argv[])
{
  if (argc < 2)
  {
    std::cerr << "usage: corpus FOLDER [SECONDS [MEGABYTES]]\n";
    return 2;
  }
  const rlim_t seconds = argc > 2 ? std::strtoul(argv[2], nullptr, 10) : 60;
  const rlim_t megabytes = argc > 3 ? std::strtoul(argv[3], nullptr, 10) : 4096;
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(argv[1]))
  {
    if (entry.is_regular_file())
    {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end());
  std::array<size_t, OUTCOMES> total = {};
  double slowest = 0;
  std::string slowestFile;
  for (const std::string& file : files)
  {
    std::string line;
    double longest = 0;
    for (const Set& set : Sets)
    {
      std::string said;
      const double before = ChildSeconds();
      const Outcome outcome = RunApart(file, set, seconds, megabytes, said);
      const double took = ChildSeconds() - before;
      total[outcome]++;
      longest = std::max(longest, took);
      if (took > slowest)
      {
        slowest = took;
        slowestFile = file + " (" + set.Name + ")";
      }
      std::replace(said.begin(), said.end(), '\n', ' ');
      line +=
        std::string(line.empty() ? "" : "; ") + set.Name + ": " + Names[outcome] + (said.empty() ? "" : ": ") + said;
    }
    std::cout << std::filesystem::path(file).filename().string() << ": " << line << "; " << longest << " s at most"
              << std::endl;
  }
  std::cout << files.size() << " files, " << Sets.size() << " runs each:";
  for (size_t i = 0; i < OUTCOMES; ++i)
  {
    std::cout << (i ? ", " : " ") << total[i] << " " << Names[i];
  }
  std::cout << "; slowest " << slowest << " s: " << slowestFile << "\n";
  return !files.empty() && total[CRASHED] + total[HUNG] + total[INVALID] == 0 ? 0 : 1;
}
