// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAnisotropicQuadRemesher.h"

#include "AttributeTransfer.h"
#include "InputSurface.h"
#include "ToolkitVersion.h"
#include "aqr.h"

#include "vtkAlgorithmOutput.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCompositeDataSet.h"
#include "vtkDoubleArray.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSMPTools.h"
#include "vtkSignedCharArray.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTypeInt64Array.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <list>
#include <sstream>
#include <utility>
#include <vector>

vtkStandardNewMacro(vtkAnisotropicQuadRemesher);

namespace
{
//------------------------------------------------------------------------------
int ReportProgress(void* user, double fraction, const char* stage)
{
  auto* self = static_cast<vtkAlgorithm*>(user);
  self->SetProgressText(stage);
  self->UpdateProgress(fraction);
  return ShouldAbort(self, 0) ? 0 : 1;
}

//------------------------------------------------------------------------------
void ParallelFor(void*, size_t count, size_t grain, void (*body)(void* data, size_t begin, size_t end), void* data)
{
  vtkSMPTools::For(0, static_cast<vtkIdType>(count), static_cast<vtkIdType>(grain),
    [=](vtkIdType begin, vtkIdType end) { body(data, static_cast<size_t>(begin), static_cast<size_t>(end)); });
}

//------------------------------------------------------------------------------
// Small enumerations go into vtkSignedCharArray, since mappers take unsigned char for colors.
template <typename ArrayT, typename T>
vtkSmartPointer<ArrayT> NewArray(const char* name, const T* values, size_t tuples, int components = 1)
{
  auto array = vtkSmartPointer<ArrayT>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(tuples));
  std::copy_n(values, tuples * static_cast<size_t>(components), array->GetPointer(0));
  return array;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPoints> NewPoints(const double* values, size_t count, int dataType)
{
  auto points = vtkSmartPointer<vtkPoints>::New();
  if (dataType == VTK_FLOAT)
  {
    points->SetData(NewArray<vtkFloatArray>("Points", values, count, 3));
  }
  else
  {
    points->SetData(NewArray<vtkDoubleArray>("Points", values, count, 3));
  }
  return points;
}

//------------------------------------------------------------------------------
// VTK's arrays of fixed width are declared with another name for the same 64-bit integer.
template <typename T>
vtkSmartPointer<vtkCellArray> NewCells(const int64_t* offsets, size_t count, const T* connectivity)
{
  auto cells = vtkSmartPointer<vtkCellArray>::New();
  cells->SetData(NewArray<vtkTypeInt64Array>("Offsets", offsets, count + 1),
    NewArray<vtkTypeInt64Array>("Connectivity", connectivity, static_cast<size_t>(offsets[count])));
  return cells;
}

//------------------------------------------------------------------------------
std::vector<vtkIdType> SourceCells(const InputSurface& triangles, const aqr_index* source, size_t count)
{
  std::vector<vtkIdType> cells(count);
  std::transform(source, source + count, cells.begin(), [&](aqr_index t) { return triangles.Cell(t); });
  return cells;
}

//------------------------------------------------------------------------------
// The cleaned surface with the arrays of the input.
vtkSmartPointer<vtkPolyData> NewFieldSurface(
  vtkPolyData* input, const InputSurface& source, const aqr_field_view& field)
{
  const size_t triangles = field.number_of_triangles;
  std::vector<int64_t> offsets(triangles + 1);
  for (size_t t = 0; t <= triangles; ++t)
  {
    offsets[t] = static_cast<int64_t>(3 * t);
  }
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  surface->SetPoints(NewPoints(field.points, field.number_of_points, input->GetPoints()->GetDataType()));
  surface->SetPolys(NewCells(offsets.data(), triangles, field.triangles));
  InterpolatePointData(input->GetPointData(), field.origins, field.number_of_points, surface->GetPointData());
  const auto cells = SourceCells(source, field.triangle_source, triangles);
  CopyCellData(input->GetCellData(), cells, surface->GetCellData());
  surface->GetCellData()->AddArray(NewArray<vtkIdTypeArray>("SourceCellId", cells.data(), triangles));
  return surface;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> NewDirections(vtkPolyData* surface, const aqr_field_view& field)
{
  const size_t points = field.number_of_points;
  auto directions = vtkSmartPointer<vtkPolyData>::New();
  directions->ShallowCopy(surface);
  vtkPointData* data = directions->GetPointData();
  data->SetNormals(NewArray<vtkFloatArray>("Normals", field.normals, points, 3));
  data->AddArray(NewArray<vtkFloatArray>("MinDirection", field.min_direction, points, 3));
  data->SetActiveVectors("MinDirection"); // what glyphs take by themselves; SetVectors() would drop the input's
  data->AddArray(NewArray<vtkFloatArray>("MaxDirection", field.max_direction, points, 3));
  data->AddArray(NewArray<vtkDoubleArray>("MinCurvature", field.min_curvature, points));
  data->AddArray(NewArray<vtkDoubleArray>("MaxCurvature", field.max_curvature, points));
  return directions;
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> NewConfidence(vtkPolyData* surface, const aqr_field_view& field)
{
  auto confidence = vtkSmartPointer<vtkPolyData>::New();
  confidence->ShallowCopy(surface);
  confidence->GetPointData()->AddArray(
    NewArray<vtkFloatArray>("Confidence", field.point_confidence, field.number_of_points));
  confidence->GetPointData()->SetActiveScalars("Confidence"); // SetScalars() would drop the input's
  confidence->GetCellData()->AddArray(
    NewArray<vtkFloatArray>("Confidence", field.triangle_confidence, field.number_of_triangles));
  return confidence;
}

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
// What the ports of the field are made of: where nothing of it changes they serve again.
struct FieldSources
{
  vtkSmartPointer<vtkPointData> PointData; // kept, as all objects here, so that no other can take its address
  vtkSmartPointer<vtkCellData> CellData;
  vtkMTimeType Time = 0;
  int Precision = 0;
  uint64_t Revision = 0;

  FieldSources() = default;
  FieldSources(vtkPolyData* input, const aqr_field_view& field)
    : PointData(input->GetPointData())
    , CellData(input->GetCellData())
    , Time(std::max(PointData->GetMTime(), CellData->GetMTime()))
    , Precision(input->GetPoints()->GetDataType())
    , Revision(field.revision)
  {
  }
  bool operator==(const FieldSources& other) const
  {
    return this->PointData == other.PointData && this->CellData == other.CellData && this->Time == other.Time &&
           this->Precision == other.Precision && this->Revision == other.Revision;
  }
};

//------------------------------------------------------------------------------
// One surface and the stages computed for it.
struct Slot
{
  aqr_remesher* Remesher = nullptr;
  InputSurface Surface;
  vtkSmartPointer<vtkPoints> Points; // none where the remesher holds no surface
  SurfaceTimes Times = {};
  std::vector<int64_t> Locked;
  SurfaceDigest Digest = {};
  unsigned long Turn = 0;
  FieldSources FieldMadeOf;
  vtkSmartPointer<vtkPolyData> Directions; // the last outputs of their ports, or none
  vtkSmartPointer<vtkPolyData> Confidence;

  Slot() = default;
  Slot(const Slot&) = delete;
  void operator=(const Slot&) = delete;
  ~Slot() { aqr_remesher_free(this->Remesher); }

  aqr_status SetHooks(const aqr_hooks& hooks)
  {
    if (this->Remesher)
    {
      aqr_remesher_set_hooks(this->Remesher, &hooks);
      return AQR_OK;
    }
    return aqr_remesher_new(&hooks, &this->Remesher);
  }
};
}

//------------------------------------------------------------------------------
class vtkAnisotropicQuadRemesher::vtkInternals
{
public:
  // The executive runs a filter for polygonal data once for each block of a composite data set, after it has
  // asked for the whole. The surfaces of the last turn are kept, since the next brings them again.
  void BeginBlocks(vtkAlgorithmOutput* connection)
  {
    if (this->TurnIsUsed)
    {
      this->Slots.remove_if([&](const Slot& slot) { return slot.Turn != this->Turn; });
      this->Turn++;
      this->TurnIsUsed = false;
    }
    this->Blocks = connection;
  }

  // Makes current the slot that holds this surface, or else hands the surface to the one longest unused.
  aqr_status SetInput(vtkPolyData* input, const aqr_hooks& hooks)
  {
    const SurfaceTimes times = TimesOf(input);
    const auto unchanged = [&](const Slot& slot)
    { return slot.Points && slot.Times == times && slot.Locked == this->Locked; };
    auto found = std::find_if(this->Slots.begin(), this->Slots.end(), unchanged);
    SurfaceDigest digest = {};
    if (found == this->Slots.end())
    {
      digest = DigestOf(input);
      found = std::find_if(this->Slots.begin(), this->Slots.end(),
        [&](const Slot& slot) { return slot.Points && slot.Digest == digest && slot.Locked == this->Locked; });
    }
    const bool known = found != this->Slots.end();
    if (known)
    {
      this->Slots.splice(this->Slots.begin(), this->Slots, found);
    }
    else if (this->Slots.empty() || this->InBlocks)
    {
      this->Slots.emplace_front();
    }
    else
    {
      this->Slots.splice(this->Slots.begin(), this->Slots, std::prev(this->Slots.end()));
    }
    if (!this->InBlocks)
    {
      this->Slots.resize(1);
    }
    Slot& slot = this->Slots.front();
    slot.Turn = this->Turn;
    this->TurnIsUsed = true;
    aqr_status status = slot.SetHooks(hooks);
    if (status == AQR_OK && !known)
    {
      slot.Points = nullptr;
      status = slot.Surface.Give(input, this->Locked, slot.Remesher);
      slot.Digest = digest;
      slot.Locked = this->Locked;
    }
    if (status == AQR_OK)
    {
      slot.Points = input->GetPoints();
      slot.Times = times;
    }
    return status;
  }

  aqr_remesher* Remesher() const { return this->Slots.empty() ? nullptr : this->Slots.front().Remesher; }
  const InputSurface& Surface() const { return this->Slots.front().Surface; }
  Slot& Current() { return this->Slots.front(); }

  std::string Counts() const
  {
    const aqr_report* report = aqr_remesher_report(this->Remesher());
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
    if (const aqr_mesh* mesh = aqr_remesher_mesh(this->Remesher()))
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

  std::string Stages() const
  {
    size_t count = 0;
    const aqr_stage* stages = aqr_remesher_stages(this->Remesher(), &count);
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

  // Sentences about everything that was not as it should be.
  void CollectWarnings(vtkPolyData* input, bool lockLines)
  {
    const aqr_report* report = aqr_remesher_report(this->Remesher());
    const std::pair<size_t, const char*> repairs[] = {
      { report->degenerate_triangles, "degenerate triangles dropped" },
      { report->duplicate_triangles, "duplicate triangles dropped" },
      { report->split_edges, "non-manifold edges cut apart" },
      { report->split_points, "non-manifold points cut apart" },
      { report->flipped_triangles, "triangles turned to agree with their neighbours" },
      { report->unorientable_edges, "edges cut because no orientation agrees across them" },
    };
    std::string list;
    for (const auto& repair : repairs)
    {
      if (repair.first)
      {
        list += (list.empty() ? "" : ", ") + std::to_string(repair.first) + " " + repair.second;
      }
    }
    this->Warnings.clear();
    if (!list.empty())
    {
      this->Warnings.push_back("The input was repaired: " + list + ".");
    }
    const vtkIdType lines = lockLines ? 0 : input->GetNumberOfLines();
    if (input->GetNumberOfVerts() + lines > 0)
    {
      this->Warnings.push_back("Vertices and lines of the input were passed over: " +
                               std::to_string(input->GetNumberOfVerts()) + " and " + std::to_string(lines) + " cells.");
    }
    if (report->locked_missed)
    {
      this->Warnings.push_back(std::to_string(report->locked_missed) + " of " +
                               std::to_string(this->Locked.size() / 2) +
                               " locked edges are no edges of the input's polygons and were passed over.");
    }
    if (report->given_up_edges)
    {
      this->Warnings.push_back("So few points cannot follow all creases: " + std::to_string(report->given_up_edges) +
                               " edges of those that bend the surface least are no feature lines.");
    }
    if (report->coarsened_components)
    {
      this->Warnings.push_back(std::to_string(report->coarsened_components) +
                               " components were too small to carry lines at this density and were decimated instead.");
    }
    if (report->asymmetric_points)
    {
      this->Warnings.push_back(std::to_string(report->asymmetric_points) +
                               " points of the input have no other at their mirror image: the output is what lies on "
                               "the positive side of the plane of symmetry, and its image.");
    }
    if (report->topology_lost)
    {
      this->Warnings.push_back("No attempt kept the input's topology: the output has another Euler number.");
    }
    const aqr_mesh* mesh = aqr_remesher_mesh(this->Remesher());
    if (report->bounded_points)
    {
      this->Warnings.push_back("The largest spacing is smaller than the input can carry at " +
                               std::to_string(report->bounded_points) +
                               " of its points: lines stay a quarter of the distance of the points apart there.");
    }
    if (report->target_missed && mesh)
    {
      this->Warnings.push_back("The target number of points could not be met within 5 percent: the boundary, the "
                               "features or the topology of the input ask for another number. The output has " +
                               std::to_string(mesh->number_of_points) + " points.");
    }
  }

  std::list<Slot> Slots; // the current one first
  bool InBlocks = false;
  vtkAlgorithmOutput* Blocks = nullptr; // only compared: the connection that last had a composite data set
  unsigned long Turn = 0;
  bool TurnIsUsed = false;
  std::vector<double> DensityScale;
  std::vector<int64_t> Locked; // the points at the ends of every edge that lines lock
  std::vector<std::string> Warnings;
};

//------------------------------------------------------------------------------
vtkAnisotropicQuadRemesher::vtkAnisotropicQuadRemesher()
  : Internals(new vtkInternals)
{
  this->SetNumberOfOutputPorts(4);
}

//------------------------------------------------------------------------------
vtkAnisotropicQuadRemesher::~vtkAnisotropicQuadRemesher() = default;

//------------------------------------------------------------------------------
int vtkAnisotropicQuadRemesher::FillOutputPortInformation(int vtkNotUsed(port), vtkInformation* info)
{
  info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkPolyData");
  return 1;
}

//------------------------------------------------------------------------------
bool vtkAnisotropicQuadRemesher::ReadDensityArray(vtkInformationVector** inputVector, vtkPolyData* input)
{
  this->Internals->DensityScale.clear();
  if (!this->UseDensityArray)
  {
    return true;
  }
  int association = vtkDataObject::FIELD_ASSOCIATION_POINTS;
  vtkDataArray* scale = this->GetInputArrayToProcess(0, inputVector, association);
  vtkInformation* asked = this->GetInputArrayInformation(0);
  const char* name = asked->Get(vtkDataObject::FIELD_NAME());
  if (!scale)
  {
    vtkErrorMacro("The input has no array named \"" << (name ? name : "") << "\" to scale the density by.");
    return false;
  }
  if (association != vtkDataObject::FIELD_ASSOCIATION_POINTS || scale->GetNumberOfComponents() != 1 ||
      scale->GetNumberOfTuples() != input->GetNumberOfPoints())
  {
    vtkErrorMacro("The array \"" << scale->GetName() << "\" cannot scale the density: it must be a point array "
                                 << "with one component.");
    return false;
  }
  this->Internals->DensityScale.resize(static_cast<size_t>(scale->GetNumberOfTuples()));
  for (vtkIdType i = 0; i < scale->GetNumberOfTuples(); ++i)
  {
    const double value = scale->GetComponent(i, 0);
    if (!(value > 0.0) || !std::isfinite(value))
    {
      vtkErrorMacro("The array \"" << scale->GetName() << "\" cannot scale the density: value " << i << " is " << value
                                   << ", but all must be finite and greater than zero.");
      return false;
    }
    this->Internals->DensityScale[static_cast<size_t>(i)] = value;
  }
  return true;
}

//------------------------------------------------------------------------------
bool vtkAnisotropicQuadRemesher::ReadLockedLines(vtkInformationVector** inputVector, vtkPolyData* input)
{
  this->Internals->Locked.clear();
  if (!this->LockLines)
  {
    return true;
  }
  vtkDataArray* chosen = nullptr;
  if (this->UseLockArray)
  {
    int association = vtkDataObject::FIELD_ASSOCIATION_CELLS;
    chosen = this->GetInputArrayToProcess(1, inputVector, association);
    const char* name = this->GetInputArrayInformation(1)->Get(vtkDataObject::FIELD_NAME());
    if (!chosen)
    {
      vtkErrorMacro("The input has no array named \"" << (name ? name : "") << "\" to lock lines by.");
      return false;
    }
    if (association != vtkDataObject::FIELD_ASSOCIATION_CELLS || chosen->GetNumberOfComponents() != 1 ||
        chosen->GetNumberOfTuples() != input->GetNumberOfCells())
    {
      vtkErrorMacro("The array \"" << chosen->GetName() << "\" cannot lock lines: it must be a cell array "
                                   << "with one component.");
      return false;
    }
  }
  this->Internals->Locked = LineSegments(input, chosen);
  return true;
}

//------------------------------------------------------------------------------
int vtkAnisotropicQuadRemesher::RunKernels(vtkPolyData* input)
{
  aqr_options options = aqr_default_options();
  options.density = this->DensityMode == TOLERANCE ? AQR_DENSITY_TOLERANCE : AQR_DENSITY_POINTS;
  options.tolerance = this->Tolerance;
  options.target_points = this->TargetNumberOfPoints;
  options.density_scale = this->Internals->DensityScale.empty() ? nullptr : this->Internals->DensityScale.data();
  options.curvature_radius = this->CurvatureRadius;
  options.smoothing_iterations = this->SmoothingIterations;
  options.confidence_angle = this->ConfidenceAngle;
  options.feature_lines = this->FeatureLines;
  options.feature_angle = this->FeatureAngle;
  options.boundary_lines = this->BoundaryLines;
  options.largest_spacing = this->LargestSpacing;
  options.anisotropy = this->Anisotropy;
  options.adaptivity = this->Adaptivity;
  options.pure_quads = this->PureQuads;
  options.symmetry = this->Symmetry;
  std::copy_n(this->SymmetryOrigin, 3, options.symmetry_origin);
  std::copy_n(this->SymmetryNormal, 3, options.symmetry_normal);
  options.largest_valence = this->LargestValence;
  options.convex_partition = this->ConvexPartition;
  options.preserve_topology = this->PreserveTopology;
  options.seed = static_cast<uint32_t>(this->Seed);
  options.show_field = this->GenerateDirections || this->GenerateConfidence || this->GenerateLines;
  options.show_lines = this->GenerateLines;

  vtkInternals& internals = *this->Internals;
  aqr_status status = AQR_OK;
  aqr_hooks hooks = {};
  hooks.user = static_cast<vtkAlgorithm*>(this);
  hooks.progress = ReportProgress;
  hooks.parallel_for = this->NumberOfThreads == 1 ? nullptr : ParallelFor;
  const auto run = [&]
  {
    status = internals.SetInput(input, hooks);
    if (status == AQR_OK)
    {
      status = aqr_remesher_run(internals.Remesher(), &options);
    }
  };
  // The backend named here is in every VTK since 9.1, whereas the default one may be sequential.
  vtkSMPTools::LocalScope(vtkSMPTools::Config{ this->NumberOfThreads, "STDThread", false }, run);
  return status;
}

//------------------------------------------------------------------------------
void vtkAnisotropicQuadRemesher::FillRemeshed(vtkPolyData* input, vtkPolyData* output)
{
  const aqr_mesh* mesh = aqr_remesher_mesh(this->Internals->Remesher());
  const int precision = input->GetPoints()->GetDataType();
  output->SetPoints(NewPoints(mesh->points, mesh->number_of_points, precision));
  output->SetPolys(NewCells(mesh->offsets, mesh->number_of_faces, mesh->connectivity));

  vtkPointData* pointData = output->GetPointData();
  InterpolatePointData(input->GetPointData(), mesh->origins, mesh->number_of_points, pointData);
  // Not the active normals: one normal a point would blur the creases of a mesh that shares its points.
  pointData->AddArray(NewArray<vtkFloatArray>("Normals", mesh->normals, mesh->number_of_points, 3));
  pointData->AddArray(NewArray<vtkSignedCharArray>("PointKind", mesh->point_kind, mesh->number_of_points));

  const auto sources = SourceCells(this->Internals->Surface(), mesh->face_source, mesh->number_of_faces);
  CopyCellData(input->GetCellData(), sources, output->GetCellData());
  std::vector<int> sides(mesh->number_of_faces);
  for (size_t f = 0; f < mesh->number_of_faces; ++f)
  {
    sides[f] = static_cast<int>(mesh->offsets[f + 1] - mesh->offsets[f]);
  }
  output->GetCellData()->AddArray(NewArray<vtkSignedCharArray>("NumberOfSides", sides.data(), sides.size()));
  output->GetCellData()->AddArray(NewArray<vtkIdTypeArray>("SourceCellId", sources.data(), sources.size()));
}

//------------------------------------------------------------------------------
void vtkAnisotropicQuadRemesher::FillField(vtkPolyData* input, vtkPolyData* directions, vtkPolyData* confidence)
{
  Slot& slot = this->Internals->Current();
  const aqr_field_view* field = aqr_remesher_field(slot.Remesher);
  if (!field) // neither is asked for
  {
    slot.Directions = nullptr;
    slot.Confidence = nullptr;
    return;
  }
  const FieldSources sources(input, *field);
  const bool hold = sources == slot.FieldMadeOf;
  if (!hold || !this->GenerateDirections)
  {
    slot.Directions = nullptr;
  }
  if (!hold || !this->GenerateConfidence)
  {
    slot.Confidence = nullptr;
  }
  slot.FieldMadeOf = sources;
  const bool makeDirections = this->GenerateDirections && !slot.Directions;
  const bool makeConfidence = this->GenerateConfidence && !slot.Confidence;
  if (makeDirections || makeConfidence)
  {
    const auto surface = NewFieldSurface(input, slot.Surface, *field);
    slot.Directions = makeDirections ? NewDirections(surface, *field) : slot.Directions;
    slot.Confidence = makeConfidence ? NewConfidence(surface, *field) : slot.Confidence;
  }
  if (slot.Directions)
  {
    directions->ShallowCopy(slot.Directions);
  }
  if (slot.Confidence)
  {
    confidence->ShallowCopy(slot.Confidence);
  }
}

//------------------------------------------------------------------------------
void vtkAnisotropicQuadRemesher::FillLines(vtkPolyData* input, vtkPolyData* output)
{
  const aqr_lines_view* lines = aqr_remesher_lines(this->Internals->Remesher());
  const aqr_field_view* field = aqr_remesher_field(this->Internals->Remesher());
  const size_t points = lines->number_of_points;
  const size_t count = lines->number_of_lines;
  std::vector<int64_t> order(std::max(points, count));
  for (size_t i = 0; i < order.size(); ++i)
  {
    order[i] = static_cast<int64_t>(i);
  }
  output->SetPoints(NewPoints(lines->points, points, input->GetPoints()->GetDataType()));
  output->SetLines(NewCells(lines->offsets, count, order.data()));

  vtkPointData* pointData = output->GetPointData();
  std::vector<vtkIdType> cells(points);
  for (size_t p = 0; p < points; ++p)
  {
    cells[p] = this->Internals->Surface().Cell(field->triangle_source[lines->triangle[p]]);
  }
  pointData->AddArray(NewArray<vtkDoubleArray>("Curvature", lines->curvature, points));
  pointData->AddArray(NewArray<vtkDoubleArray>("ArcLength", lines->arc_length, points));
  pointData->AddArray(NewArray<vtkIdTypeArray>("SourceCellId", cells.data(), points));
  pointData->AddArray(NewArray<vtkSignedCharArray>("Isotropic", lines->isotropic, points));

  std::vector<uint8_t> reasons[2];
  for (size_t end = 0; end < 2; ++end)
  {
    reasons[end].resize(count);
    for (size_t i = 0; i < count; ++i)
    {
      reasons[end][i] = lines->ends[2 * i + end];
    }
  }
  vtkCellData* cellData = output->GetCellData();
  cellData->SetScalars(NewArray<vtkSignedCharArray>("LineType", lines->type, count));
  cellData->AddArray(NewArray<vtkIdTypeArray>("LineId", order.data(), count));
  cellData->AddArray(NewArray<vtkSignedCharArray>("StartReason", reasons[0].data(), count));
  cellData->AddArray(NewArray<vtkSignedCharArray>("EndReason", reasons[1].data(), count));
}

//------------------------------------------------------------------------------
vtkTypeBool vtkAnisotropicQuadRemesher::ProcessRequest(
  vtkInformation* request, vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  if (request->Has(vtkStreamingDemandDrivenPipeline::REQUEST_UPDATE_EXTENT()) &&
      vtkCompositeDataSet::SafeDownCast(vtkDataObject::GetData(inputVector[0], 0)))
  {
    this->Internals->BeginBlocks(this->GetInputConnection(0, 0));
  }
  return this->Superclass::ProcessRequest(request, inputVector, outputVector);
}

//------------------------------------------------------------------------------
int vtkAnisotropicQuadRemesher::RequestData(
  vtkInformation* vtkNotUsed(request), vtkInformationVector** inputVector, vtkInformationVector* outputVector)
{
  vtkPolyData* input = vtkPolyData::GetData(inputVector[0], 0);
  vtkPolyData* outputs[4];
  for (int port = 0; port < 4; ++port)
  {
    outputs[port] = vtkPolyData::GetData(outputVector, port);
    outputs[port]->Initialize();
  }
  vtkInternals& internals = *this->Internals;
  internals.Warnings.clear();
  internals.InBlocks = internals.Blocks && internals.Blocks == this->GetInputConnection(0, 0);
  this->SetErrorCode(vtkErrorCode::NoError);

  if (input->GetNumberOfPoints() == 0 || input->GetNumberOfPolys() + input->GetNumberOfStrips() == 0)
  {
    if (internals.InBlocks)
    {
      return 1; // blocks and pieces of a larger data set may well be empty
    }
    vtkErrorMacro("The input has no polygons to remesh.");
    this->SetErrorCode(vtkErrorCode::UserError + AQR_EMPTY_INPUT);
    return 1;
  }
  if (!this->ReadDensityArray(inputVector, input) || !this->ReadLockedLines(inputVector, input))
  {
    this->SetErrorCode(vtkErrorCode::UserError + AQR_BAD_OPTION);
    return 1;
  }
  const auto status = static_cast<aqr_status>(this->RunKernels(input));
  if (status == AQR_CANCELLED)
  {
    return 1;
  }
  if (status != AQR_OK)
  {
    const std::string detail = internals.Remesher() ? aqr_remesher_message(internals.Remesher()) : "";
    vtkErrorMacro(<< aqr_status_string(status) << (detail.empty() ? "" : ": ") << detail);
    this->SetErrorCode(vtkErrorCode::UserError + status);
    return 1;
  }

  this->FillRemeshed(input, outputs[REMESHED]);
  this->FillField(input, outputs[PRINCIPAL_DIRECTIONS], outputs[CONFIDENCE]);
  if (this->GenerateLines)
  {
    this->FillLines(input, outputs[INTEGRATED_LINES]);
  }
  for (vtkPolyData* output : outputs)
  {
    output->GetFieldData()->PassData(input->GetFieldData());
  }

  internals.CollectWarnings(input, this->LockLines);
  if (!internals.Warnings.empty())
  {
    std::string all;
    for (const std::string& warning : internals.Warnings)
    {
      all += (all.empty() ? "" : " ") + warning;
    }
    vtkWarningMacro(<< all);
  }
  return 1;
}

//------------------------------------------------------------------------------
std::string vtkAnisotropicQuadRemesher::GetReport() const
{
  if (!this->Internals->Remesher())
  {
    return "{}";
  }
  std::string warnings;
  for (const std::string& warning : this->Internals->Warnings)
  {
    warnings += (warnings.empty() ? "" : ", ") + Quoted(warning);
  }
  return "{\"counts\": " + this->Internals->Counts() + ", \"warnings\": [" + warnings +
         "], \"stages\": " + this->Internals->Stages() + "}";
}

//------------------------------------------------------------------------------
void vtkAnisotropicQuadRemesher::PrintSelf(ostream& os, vtkIndent indent)
{
  const auto onOff = [](bool value) { return value ? "On\n" : "Off\n"; };
  this->Superclass::PrintSelf(os, indent);
  os << indent << "DensityMode: " << (this->DensityMode == TOLERANCE ? "Tolerance\n" : "NumberOfPoints\n");
  os << indent << "Tolerance: " << this->Tolerance << "\n";
  os << indent << "TargetNumberOfPoints: " << this->TargetNumberOfPoints << "\n";
  os << indent << "UseDensityArray: " << onOff(this->UseDensityArray);
  os << indent << "CurvatureRadius: " << this->CurvatureRadius << "\n";
  os << indent << "SmoothingIterations: " << this->SmoothingIterations << "\n";
  os << indent << "ConfidenceAngle: " << this->ConfidenceAngle << "\n";
  os << indent << "FeatureLines: " << onOff(this->FeatureLines);
  os << indent << "FeatureAngle: " << this->FeatureAngle << "\n";
  os << indent << "BoundaryLines: " << onOff(this->BoundaryLines);
  os << indent << "LockLines: " << onOff(this->LockLines);
  os << indent << "UseLockArray: " << onOff(this->UseLockArray);
  os << indent << "LargestSpacing: " << this->LargestSpacing << "\n";
  os << indent << "Anisotropy: " << this->Anisotropy << "\n";
  os << indent << "Adaptivity: " << this->Adaptivity << "\n";
  os << indent << "PureQuads: " << onOff(this->PureQuads);
  os << indent << "Symmetry: " << onOff(this->Symmetry);
  os << indent << "SymmetryOrigin: " << this->SymmetryOrigin[0] << " " << this->SymmetryOrigin[1] << " "
     << this->SymmetryOrigin[2] << "\n";
  os << indent << "SymmetryNormal: " << this->SymmetryNormal[0] << " " << this->SymmetryNormal[1] << " "
     << this->SymmetryNormal[2] << "\n";
  os << indent << "LargestValence: " << this->LargestValence << "\n";
  os << indent << "ConvexPartition: " << onOff(this->ConvexPartition);
  os << indent << "PreserveTopology: " << onOff(this->PreserveTopology);
  os << indent << "Seed: " << this->Seed << "\n";
  os << indent << "NumberOfThreads: " << this->NumberOfThreads << "\n";
  os << indent << "GenerateDirections: " << onOff(this->GenerateDirections);
  os << indent << "GenerateConfidence: " << onOff(this->GenerateConfidence);
  os << indent << "GenerateLines: " << onOff(this->GenerateLines);
}
