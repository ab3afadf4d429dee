// SPDX-License-Identifier: BSD-3-Clause
#include "Options.h"

#include "vtkAnisotropicQuadRemesher.h"
#include "vtkDataObject.h"
#include "vtkNew.h"

#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <sstream>
#include <vector>

namespace
{
using Filter = vtkAnisotropicQuadRemesher;

struct Option
{
  std::string Name;
  std::string Argument; // empty: a switch
  std::string Help;
  std::function<void(const std::string& value)> Apply;
};

//------------------------------------------------------------------------------
template <typename T>
std::string Text(T value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

//------------------------------------------------------------------------------
double Number(const std::string& name, const std::string& text, double low, double high, bool whole)
{
  char* end = nullptr;
  const double value = std::strtod(text.c_str(), &end);
  if (text.empty() || *end != '\0' || !std::isfinite(value) || (whole && value != std::floor(value)))
  {
    throw UsageError(name + ": \"" + text + "\" is not " + (whole ? "a whole number" : "a number"));
  }
  if (value < low || value > high)
  {
    std::ostringstream range;
    range.precision(10);
    range << name << ": " << text << " is outside [" << low << ", " << high << "]";
    throw UsageError(range.str());
  }
  return value;
}

//------------------------------------------------------------------------------
void SetSymmetry(Filter* filter, const std::string& text)
{
  double plane[6] = { 0.0, 0.0, 0.0, 0.0, 0.0, 0.0 };
  if (text == "x" || text == "y" || text == "z")
  {
    plane[text[0] - 'x'] = 1.0;
  }
  else
  {
    std::istringstream words(text);
    std::string word;
    size_t n = 0;
    const double most = std::numeric_limits<double>::max();
    for (; std::getline(words, word, ','); ++n)
    {
      const double number = Number("--symmetry", word, -most, most, false);
      if (n < 6)
      {
        plane[n] = number;
      }
    }
    if (n != 6 || (plane[0] == 0.0 && plane[1] == 0.0 && plane[2] == 0.0))
    {
      throw UsageError("--symmetry: \"" + text + "\" is neither x, y or z nor NX,NY,NZ,OX,OY,OZ");
    }
  }
  filter->SymmetryOn();
  filter->SetSymmetryNormal(plane);
  filter->SetSymmetryOrigin(plane + 3);
}

//------------------------------------------------------------------------------
// The ranges are those of the setters, whose Get...MinValue() and Get...MaxValue() state them.
#define AQR_NUMBER(option, argument, parameter, whole, help)                                                           \
  Option                                                                                                               \
  {                                                                                                                    \
    option, argument, std::string(help) + "; default " + Text(filter->Get##parameter()),                               \
      [filter](const std::string& value)                                                                               \
    {                                                                                                                  \
      using T = decltype(filter->Get##parameter());                                                                    \
      filter->Set##parameter(                                                                                          \
        static_cast<T>(Number(option, value, static_cast<double>(filter->Get##parameter##MinValue()),                  \
          static_cast<double>(filter->Get##parameter##MaxValue()), whole)));                                           \
    }                                                                                                                  \
  }

#define AQR_SWITCH(option, parameter, state, help)                                                                     \
  Option                                                                                                               \
  {                                                                                                                    \
    option, "", help, [filter](const std::string&) { filter->parameter##state(); }                                     \
  }

//------------------------------------------------------------------------------
std::vector<Option> AllOptions(Filter* filter, Options& options)
{
  const auto path = [](std::string& target) { return [&target](const std::string& value) { target = value; }; };
  return {
    { "--points", "N", "points of the output, met within 5 percent; default: the density follows from --tolerance",
      [filter](const std::string& value)
      {
        filter->SetDensityModeToNumberOfPoints();
        filter->SetTargetNumberOfPoints(static_cast<vtkIdType>(
          Number("--points", value, static_cast<double>(filter->GetTargetNumberOfPointsMinValue()),
            static_cast<double>(filter->GetTargetNumberOfPointsMaxValue()), true)));
      } },
    AQR_NUMBER("--tolerance", "T", Tolerance, false,
      "departure of the chords between lines from the surface, as a fraction of the bounding box's diagonal"),
    { "--density-array", "NAME", "multiply the points per area by this point array of the input; default: none",
      [filter](const std::string& value)
      {
        filter->UseDensityArrayOn();
        filter->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS, value.c_str());
      } },
    AQR_NUMBER("--largest-spacing", "F", LargestSpacing, false,
      "largest distance of neighbouring lines, as a fraction of the diagonal"),
    AQR_NUMBER("--anisotropy", "F", Anisotropy, false,
      "stretch of the faces where curvatures differ, from 0 (squares) to 1 (full)"),
    AQR_NUMBER("--adaptivity", "F", Adaptivity, false,
      "how far the density follows the curvature, from 0 (the same everywhere) to 1 (full)"),
    AQR_SWITCH("--pure-quads", PureQuads, On,
      "quads only: lines twice as far apart, then every face cut into quads; default: triangles and pentagons where "
      "lines end"),
    { "--symmetry", "PLANE",
      "make the output symmetric about the plane x, y or z (across that axis, through the origin) or NX,NY,NZ,OX,OY,OZ "
      "(normal and a point); what lies to where the normal points is mirrored; default: none",
      [filter](const std::string& value) { SetSymmetry(filter, value); } },
    AQR_NUMBER("--curvature-radius", "F", CurvatureRadius, false,
      "radius over which curvature is averaged, as a fraction of the diagonal; half of it where points lie closer than "
      "1/120 of the diagonal, a quarter below 1/240"),
    AQR_NUMBER("--smoothing", "N", SmoothingIterations, true, "smoothing iterations of the direction field"),
    AQR_NUMBER("--confidence-angle", "A", ConfidenceAngle, false,
      "degrees by which directions may differ inside a face before it counts as isotropic"),
    AQR_NUMBER("--feature-angle", "A", FeatureAngle, false,
      "degrees by which two faces depart from flat before their edge counts as a crease"),
    AQR_SWITCH("--no-features", FeatureLines, Off, "do not keep creases; default: they become edges"),
    AQR_SWITCH("--no-boundary", BoundaryLines, Off, "do not follow the boundary; default: it becomes edges"),
    AQR_SWITCH("--lock-lines", LockLines, On,
      "keep the lines of INPUT, which must run along its edges, as edges; default: they are passed over"),
    { "--lock-array", "NAME", "keep those lines only where this cell array of INPUT is not zero; default: all",
      [filter](const std::string& value)
      {
        filter->LockLinesOn();
        filter->UseLockArrayOn();
        filter->SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, value.c_str());
      } },
    AQR_NUMBER("--largest-valence", "N", LargestValence, true, "most corners a face may have"),
    AQR_SWITCH("--no-convex", ConvexPartition, Off, "leave concave faces as they are; default: they are split"),
    AQR_SWITCH("--no-topology", PreserveTopology, Off,
      "let handles and holes smaller than the spacing vanish; default: keep all"),
    AQR_NUMBER("--seed", "N", Seed, true, "breaks ties between equally good places to begin a line"),
    AQR_NUMBER("--threads", "N", NumberOfThreads, true, "threads, 0 for all; the result does not depend on it"),
    { "--lines", "FILE", "also write the traced lines, to .vtp or .vtk; default: none", path(options.Lines) },
    { "--directions", "FILE", "also write the principal directions, to .vtp or .vtk; default: none",
      path(options.Directions) },
    { "--confidence", "FILE", "also write the confidence of the directions, to .vtp or .vtk; default: none",
      path(options.Confidence) },
    { "--picture", "FILE", "also render the output to a .png, which needs an X display; default: none",
      path(options.Picture) },
    { "--report", "FILE",
      "also write counts, warnings, and the seconds and peak memory (bytes) of every stage, as .json; default: none",
      path(options.Report) },
    { "--summary", "",
      "also print the points, faces, quads and tolerance of the output, and how far creases and borders are from its "
      "edges (root mean square and largest, fractions of the diagonal); default: nothing is printed",
      [&options](const std::string&) { options.Summary = true; } },
    { "--version", "", "print the version and stop", [&options](const std::string&) { options.Version = true; } },
    { "--help", "", "print this text and stop", [&options](const std::string&) { options.Help = true; } },
  };
}

//------------------------------------------------------------------------------
// Breaks text into lines of at most 96 characters, indented.
std::string Wrapped(const std::string& text, size_t indent)
{
  std::istringstream words(text);
  std::string word;
  std::string result;
  size_t column = indent;
  while (words >> word)
  {
    if (column > indent && column + 1 + word.size() > 96)
    {
      result += "\n" + std::string(indent, ' ');
      column = indent;
    }
    else if (column > indent)
    {
      result += ' ';
      ++column;
    }
    result += word;
    column += word.size();
  }
  return result;
}
}

//------------------------------------------------------------------------------
std::string HelpText()
{
  vtkNew<Filter> filter;
  Options options;
  std::string text = "usage: aqr-remesh INPUT OUTPUT [option ...]\n\n"
                     "Remesh a surface with quads along its lines of principal curvature. INPUT and OUTPUT are\n"
                     ".ply, .obj, .stl, .vtk or .vtp files; OUTPUT is replaced only once all is done.\n\n";
  constexpr size_t indent = 27;
  for (const Option& option : AllOptions(filter, options))
  {
    std::string left = "  " + option.Name + (option.Argument.empty() ? "" : " " + option.Argument);
    left.resize(indent, ' ');
    text += left + Wrapped(option.Help, indent) + "\n";
  }
  return text + "\nExit status: 0 done, 1 an input or output could not be used, 2 wrong usage.\n";
}

//------------------------------------------------------------------------------
Options ParseOptions(int argc, char** argv, Filter* filter)
{
  Options options;
  const std::vector<Option> all = AllOptions(filter, options);
  std::vector<std::string> files;
  for (int i = 1; i < argc; ++i)
  {
    const std::string word = argv[i];
    if (word.size() < 2 || word[0] != '-')
    {
      files.push_back(word);
      continue;
    }
    const Option* found = nullptr;
    for (const Option& option : all)
    {
      found = option.Name == word ? &option : found;
    }
    if (!found)
    {
      throw UsageError("unknown option " + word);
    }
    if (found->Argument.empty())
    {
      found->Apply("");
      continue;
    }
    if (i + 1 == argc)
    {
      throw UsageError(word + " needs a value");
    }
    found->Apply(argv[++i]);
  }
  if (options.Help || options.Version)
  {
    return options;
  }
  if (files.size() != 2)
  {
    throw UsageError(files.size() < 2 ? "an INPUT and an OUTPUT file are needed" : "unexpected word " + files[2]);
  }
  options.Input = files[0];
  options.Output = files[1];
  return options;
}
