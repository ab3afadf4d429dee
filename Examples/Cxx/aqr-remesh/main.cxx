// SPDX-License-Identifier: BSD-3-Clause
// aqr-remesh: remesh a surface file with quads along its lines of principal curvature.
#include "Files.h"
#include "Options.h"
#include "Picture.h"
#include "Text.h"

#include "vtkAnisotropicQuadRemesher.h"
#include "vtkCallbackCommand.h"
#include "vtkNew.h"
#include "vtkPolyData.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <sstream>
#include <string>

namespace
{
class Stopwatch
{
public:
  double Lap()
  {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double> seconds = now - this->Start;
    this->Start = now;
    return seconds.count();
  }

private:
  std::chrono::steady_clock::time_point Start = std::chrono::steady_clock::now();
};

//------------------------------------------------------------------------------
void DrawProgress(vtkObject* caller, unsigned long, void*, void*)
{
  constexpr int width = 40;
  auto* filter = static_cast<vtkAlgorithm*>(caller);
  const double fraction = std::clamp(filter->GetProgress(), 0.0, 1.0);
  const int filled = static_cast<int>(width * fraction);
  const std::string bar =
    std::string(static_cast<size_t>(filled), '#') + std::string(static_cast<size_t>(width - filled), '.');
  const char* stage = filter->GetProgressText();
  std::fprintf(stderr, "\r[%s] %3d%% %-24.24s", bar.c_str(), static_cast<int>(100 * fraction), stage ? stage : "");
}

//------------------------------------------------------------------------------
// VTK tells an observer the message alone, without the place in the source.
void KeepMessage(vtkObject*, unsigned long, void* text, void* message)
{
  std::string& kept = *static_cast<std::string*>(text);
  kept = static_cast<const char*>(message);
  const size_t begin = kept.find("): ");
  kept = kept.substr(begin == std::string::npos ? 0 : begin + 3);
  std::replace(kept.begin(), kept.end(), '\n', ' ');
  kept.erase(kept.find_last_not_of(' ') + 1);
}

//------------------------------------------------------------------------------
void Remesh(vtkAnisotropicQuadRemesher* filter, const std::string& file)
{
  std::string error;
  std::string warning;
  vtkNew<vtkCallbackCommand> keepError;
  keepError->SetCallback(KeepMessage);
  keepError->SetClientData(&error);
  filter->AddObserver(vtkCommand::ErrorEvent, keepError);
  vtkNew<vtkCallbackCommand> keepWarning;
  keepWarning->SetCallback(KeepMessage);
  keepWarning->SetClientData(&warning);
  filter->AddObserver(vtkCommand::WarningEvent, keepWarning);
  const bool terminal = isatty(STDERR_FILENO) != 0;
  if (terminal)
  {
    vtkNew<vtkCallbackCommand> draw;
    draw->SetCallback(DrawProgress);
    filter->AddObserver(vtkCommand::ProgressEvent, draw);
  }
  filter->Update();
  if (terminal)
  {
    std::fprintf(stderr, "\r%*s\r", 72, "");
  }
  if (!error.empty() || filter->GetOutput()->GetNumberOfPolys() == 0)
  {
    throw FileError(file, error.empty() ? "gives an empty mesh" : error);
  }
  if (!warning.empty())
  {
    std::cerr << "aqr-remesh: warning: " << file << ": " << warning << "\n";
  }
}

//------------------------------------------------------------------------------
void CheckOutputs(const Options& options)
{
  CheckOutput(options.Output, { ".ply", ".obj", ".stl", ".vtk", ".vtp" });
  for (const std::string* file : { &options.Lines, &options.Directions, &options.Confidence })
  {
    if (!file->empty())
    {
      CheckOutput(*file, { ".vtp", ".vtk" });
    }
  }
  if (!options.Report.empty())
  {
    CheckOutput(options.Report, { ".json" });
  }
  if (!options.Picture.empty())
  {
    CheckOutput(options.Picture, { ".png" });
    if (!HasDisplay())
    {
      throw FileError(options.Picture, "cannot be rendered: there is no X display (try xvfb-run -a)");
    }
  }
}

//------------------------------------------------------------------------------
// One line with what most want to know of the report.
void PrintSummary(const std::string& report)
{
  const auto figure = [&](const std::string& name)
  {
    const std::string key = "\"" + name + "\": ";
    const size_t begin = report.find(key) + key.size();
    return report.substr(begin, report.find_first_of(",}", begin) - begin);
  };
  std::cout << figure("points") << " points, " << figure("faces") << " faces, " << figure("quads")
            << " quads, tolerance " << figure("tolerance") << ", creases off by " << figure("feature_rms")
            << " (largest " << figure("feature_max") << "), borders by " << figure("boundary_rms") << " (largest "
            << figure("boundary_max") << ")\n";
}

//------------------------------------------------------------------------------
void Run(const Options& options, vtkAnisotropicQuadRemesher* filter, Complaints& complaints)
{
  CheckOutputs(options);

  Stopwatch watch;
  const vtkSmartPointer<vtkPolyData> input = ReadSurface(options.Input, complaints);
  const double readSeconds = watch.Lap();

  filter->SetGenerateDirections(!options.Directions.empty());
  filter->SetGenerateConfidence(!options.Confidence.empty());
  filter->SetGenerateLines(!options.Lines.empty());
  filter->SetInputData(input);
  Remesh(filter, options.Input);
  const double remeshSeconds = watch.Lap();

  OutputFiles files(complaints);
  files.WriteSurface(options.Output, filter->GetOutput());
  const std::pair<const std::string&, int> ports[] = {
    { options.Directions, vtkAnisotropicQuadRemesher::PRINCIPAL_DIRECTIONS },
    { options.Confidence, vtkAnisotropicQuadRemesher::CONFIDENCE },
    { options.Lines, vtkAnisotropicQuadRemesher::INTEGRATED_LINES },
  };
  for (const auto& [file, port] : ports)
  {
    if (!file.empty())
    {
      files.WriteSurface(file, filter->GetOutput(port));
    }
  }
  if (!options.Picture.empty() && !WritePicture(filter->GetOutput(), files.Temporary(options.Picture)))
  {
    throw FileError(options.Picture, "cannot be written");
  }
  const double writeSeconds = watch.Lap();

  if (!options.Report.empty())
  {
    rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    std::ostringstream text;
    text << "{\"program\": \"aqr-remesh " AQR_VERSION "\", \"input\": " << JsonText(options.Input)
         << ", \"input_points\": " << input->GetNumberOfPoints()
         << ", \"input_polygons\": " << input->GetNumberOfPolys() + input->GetNumberOfStrips()
         << ", \"output\": " << JsonText(options.Output) << ", \"seconds\": {\"read\": " << readSeconds
         << ", \"remesh\": " << remeshSeconds << ", \"write\": " << writeSeconds
         << "}, \"peak_bytes_of_process\": " << 1024LL * usage.ru_maxrss << ", " << filter->GetReport().substr(1)
         << "\n";
    files.WriteText(options.Report, text.str());
  }
  files.Commit();
  if (options.Summary)
  {
    PrintSummary(filter->GetReport());
  }
}
}

//------------------------------------------------------------------------------
int main(int argc, char** argv)
{
  Complaints complaints;
  try
  {
    vtkNew<vtkAnisotropicQuadRemesher> filter;
    const Options options = ParseOptions(argc, argv, filter);
    if (options.Help)
    {
      std::cout << HelpText();
    }
    else if (options.Version)
    {
      std::cout << "aqr-remesh " AQR_VERSION "\n";
    }
    else
    {
      Run(options, filter, complaints);
    }
    return 0;
  }
  catch (const UsageError& error)
  {
    std::cerr << "aqr-remesh: " << error.what() << " (see aqr-remesh --help)\n";
    return 2;
  }
  catch (const std::bad_alloc&)
  {
    std::cerr << "aqr-remesh: out of memory\n";
  }
  catch (const std::exception& error)
  {
    std::cerr << "aqr-remesh: " << error.what() << "\n";
  }
  return 1;
}
