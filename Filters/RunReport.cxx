// SPDX-License-Identifier: BSD-3-Clause
#include "RunReport.h"

#include "vtkPolyData.h"

#include <algorithm>
#include <sstream>

namespace
{
//------------------------------------------------------------------------------
std::string Quoted(const std::string& text)
{
  std::string quoted = "\"";
  for (const char c : text)
  {
    if (c == '"' || c == '\\')
    {
      quoted += '\\';
    }
    quoted += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return quoted + '"';
}

//------------------------------------------------------------------------------
// "1 edge", "2 edges"
std::string Counted(size_t count, const std::string& what)
{
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

//------------------------------------------------------------------------------
std::string Counts(const aqr_remesher* remesher)
{
  const aqr_report* report = aqr_remesher_report(remesher);
  std::ostringstream text;
  text << "{\"degenerate_triangles\": " << report->degenerate_triangles
       << ", \"duplicate_triangles\": " << report->duplicate_triangles
       << ", \"merged_points\": " << report->merged_points << ", \"unused_points\": " << report->unused_points
       << ", \"split_edges\": " << report->split_edges << ", \"split_points\": " << report->split_points
       << ", \"flipped_triangles\": " << report->flipped_triangles
       << ", \"unorientable_edges\": " << report->unorientable_edges
       << ", \"refined_points\": " << report->refined_points << ", \"feature_edges\": " << report->feature_edges
       << ", \"given_up_edges\": " << report->given_up_edges << ", \"locked_edges\": " << report->locked_edges
       << ", \"locked_missed\": " << report->locked_missed << ", \"boundary_loops\": " << report->boundary_loops
       << ", \"components\": " << report->components << ", \"lines\": " << report->lines
       << ", \"line_samples\": " << report->line_samples << ", \"proximity_queries\": " << report->proximity_queries
       << ", \"faces_crossed\": " << report->faces_crossed << ", \"bounded_points\": " << report->bounded_points
       << ", \"topology_cuts\": " << report->topology_cuts
       << ", \"coarsened_components\": " << report->coarsened_components
       << ", \"topology_lost\": " << report->topology_lost << ", \"asymmetric_points\": " << report->asymmetric_points
       << ", \"target_missed\": " << report->target_missed << ", \"tolerance\": " << report->tolerance
       << ", \"feature_rms\": " << report->feature_rms << ", \"feature_max\": " << report->feature_max
       << ", \"boundary_rms\": " << report->boundary_rms << ", \"boundary_max\": " << report->boundary_max;
  if (const aqr_mesh* mesh = aqr_remesher_mesh(remesher))
  {
    size_t sides[3] = { 0, 0, 0 };
    for (size_t f = 0; f < mesh->number_of_faces; ++f)
    {
      sides[std::clamp<int64_t>(mesh->offsets[f + 1] - mesh->offsets[f], 3, 5) - 3]++;
    }
    text << ", \"points\": " << mesh->number_of_points << ", \"faces\": " << mesh->number_of_faces
         << ", \"triangles\": " << sides[0] << ", \"quads\": " << sides[1] << ", \"larger_polygons\": " << sides[2];
  }
  text << "}";
  return text.str();
}

//------------------------------------------------------------------------------
std::string Stages(const aqr_remesher* remesher)
{
  size_t count = 0;
  const aqr_stage* stages = aqr_remesher_stages(remesher, &count);
  std::ostringstream text;
  text << "[";
  for (size_t i = 0; i < count; ++i)
  {
    text << (i ? ", " : "") << "{\"name\": " << Quoted(stages[i].name) << ", \"seconds\": " << stages[i].seconds
         << ", \"peak_bytes\": " << stages[i].peak_bytes << ", \"end_bytes\": " << stages[i].end_bytes
         << ", \"reused\": " << (stages[i].reused ? "true" : "false") << "}";
  }
  text << "]";
  return text.str();
}
}

//------------------------------------------------------------------------------
std::vector<std::string> WarningsOf(
  const aqr_remesher* remesher, vtkPolyData* input, bool lockLines, size_t lockedEdges)
{
  const aqr_report* report = aqr_remesher_report(remesher);
  const struct
  {
    size_t Count;
    const char *What, *Done;
  } repairs[] = {
    { report->degenerate_triangles, "degenerate triangle", " dropped" },
    { report->duplicate_triangles, "duplicate triangle", " dropped" },
    { report->split_edges, "non-manifold edge", " cut apart" },
    { report->split_points, "non-manifold point", " cut apart" },
    { report->flipped_triangles, "triangle", " turned to agree with the neighbours" },
    { report->unorientable_edges, "edge", " cut because no orientation agrees on both sides" },
  };
  std::string list;
  for (const auto& repair : repairs)
  {
    if (repair.Count)
    {
      list += (list.empty() ? "" : ", ") + Counted(repair.Count, repair.What) + repair.Done;
    }
  }
  std::vector<std::string> warnings;
  if (!list.empty())
  {
    warnings.push_back("The input was repaired: " + list + ".");
  }
  const vtkIdType lines = lockLines ? 0 : input->GetNumberOfLines();
  if (input->GetNumberOfVerts() + lines > 0)
  {
    warnings.push_back("Vertices and lines of the input were passed over: " +
                       std::to_string(input->GetNumberOfVerts()) + " and " + std::to_string(lines) + " cells.");
  }
  if (report->locked_missed)
  {
    warnings.push_back(std::to_string(report->locked_missed) + " of " + std::to_string(lockedEdges) +
                       " locked edges are no edges of the input's polygons and were passed over.");
  }
  if (report->given_up_edges)
  {
    warnings.push_back(
      "So few points cannot follow all creases: those that bend the surface least are no feature lines, " +
      Counted(report->given_up_edges, "edge") + " of the input.");
  }
  if (report->coarsened_components)
  {
    warnings.push_back("Too small to carry lines at this density, and decimated instead: " +
                       Counted(report->coarsened_components, "component") + ".");
  }
  if (report->asymmetric_points)
  {
    warnings.push_back("The input is not symmetric: nothing is at the mirror image of " +
                       Counted(report->asymmetric_points, "point") +
                       ". The output is what lies on the positive side of the plane of symmetry, and its image.");
  }
  if (report->topology_lost)
  {
    warnings.push_back("No attempt kept the input's topology: the output has another Euler number.");
  }
  const aqr_mesh* mesh = aqr_remesher_mesh(remesher);
  if (report->bounded_points)
  {
    warnings.push_back("The largest spacing is smaller than the input can carry at " +
                       std::to_string(report->bounded_points) +
                       " of its points: lines stay a quarter of the distance of the points apart there.");
  }
  if (report->target_missed && mesh)
  {
    warnings.push_back("The target number of points could not be met within 5 percent: the boundary, the "
                       "features or the topology of the input ask for another number. The output has " +
                       std::to_string(mesh->number_of_points) + " points.");
  }
  return warnings;
}

//------------------------------------------------------------------------------
std::string ReportOf(const aqr_remesher* remesher, const std::vector<std::string>& warnings)
{
  std::string list;
  for (const std::string& warning : warnings)
  {
    list += (list.empty() ? "" : ", ") + Quoted(warning);
  }
  return "{\"counts\": " + Counts(remesher) + ", \"warnings\": [" + list + "], \"stages\": " + Stages(remesher) + "}";
}
