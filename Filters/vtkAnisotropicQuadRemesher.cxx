// SPDX-License-Identifier: BSD-3-Clause
#include "vtkAnisotropicQuadRemesher.h"

#include "AttributeTransfer.h"
#include "KeptSurfaces.h"
#include "RunReport.h"
#include "ToolkitVersion.h"
#include "aqr.h"

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

}

//------------------------------------------------------------------------------
class vtkAnisotropicQuadRemesher::vtkInternals
{
public:
  KeptSurfaces Kept;
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
    status = internals.Kept.SetInput(input, internals.Locked, hooks);
    if (status == AQR_OK)
    {
      status = aqr_remesher_run(internals.Kept.Remesher(), &options);
    }
  };
  // The backend named here is in every VTK since 9.1, whereas the default one may be sequential.
  vtkSMPTools::LocalScope(vtkSMPTools::Config{ this->NumberOfThreads, "STDThread", false }, run);
  return status;
}

//------------------------------------------------------------------------------
void vtkAnisotropicQuadRemesher::FillRemeshed(vtkPolyData* input, vtkPolyData* output)
{
  const aqr_mesh* mesh = aqr_remesher_mesh(this->Internals->Kept.Remesher());
  const int precision = input->GetPoints()->GetDataType();
  output->SetPoints(NewPoints(mesh->points, mesh->number_of_points, precision));
  output->SetPolys(NewCells(mesh->offsets, mesh->number_of_faces, mesh->connectivity));

  vtkPointData* pointData = output->GetPointData();
  InterpolatePointData(input->GetPointData(), mesh->origins, mesh->number_of_points, pointData);
  // Not the active normals: one normal a point would blur the creases of a mesh that shares its points.
  pointData->AddArray(NewArray<vtkFloatArray>("Normals", mesh->normals, mesh->number_of_points, 3));
  pointData->AddArray(NewArray<vtkSignedCharArray>("PointKind", mesh->point_kind, mesh->number_of_points));

  const auto sources = SourceCells(this->Internals->Kept.Surface(), mesh->face_source, mesh->number_of_faces);
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
  KeptSurface& kept = this->Internals->Kept.Current();
  const aqr_field_view* field = aqr_remesher_field(kept.Remesher);
  if (!field) // neither is asked for
  {
    kept.Directions = nullptr;
    kept.Confidence = nullptr;
    return;
  }
  const FieldSources sources(input, *field);
  const bool hold = sources == kept.FieldMadeOf;
  if (!hold || !this->GenerateDirections)
  {
    kept.Directions = nullptr;
  }
  if (!hold || !this->GenerateConfidence)
  {
    kept.Confidence = nullptr;
  }
  kept.FieldMadeOf = sources;
  const bool makeDirections = this->GenerateDirections && !kept.Directions;
  const bool makeConfidence = this->GenerateConfidence && !kept.Confidence;
  if (makeDirections || makeConfidence)
  {
    const auto surface = NewFieldSurface(input, kept.Surface, *field);
    kept.Directions = makeDirections ? NewDirections(surface, *field) : kept.Directions;
    kept.Confidence = makeConfidence ? NewConfidence(surface, *field) : kept.Confidence;
  }
  if (kept.Directions)
  {
    directions->ShallowCopy(kept.Directions);
  }
  if (kept.Confidence)
  {
    confidence->ShallowCopy(kept.Confidence);
  }
}

//------------------------------------------------------------------------------
void vtkAnisotropicQuadRemesher::FillLines(vtkPolyData* input, vtkPolyData* output)
{
  const aqr_lines_view* lines = aqr_remesher_lines(this->Internals->Kept.Remesher());
  const aqr_field_view* field = aqr_remesher_field(this->Internals->Kept.Remesher());
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
    cells[p] = this->Internals->Kept.Surface().Cell(field->triangle_source[lines->triangle[p]]);
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
    this->Internals->Kept.BeginBlocks(this->GetInputConnection(0, 0));
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
  internals.Kept.Begin(this->GetInputConnection(0, 0));
  this->SetErrorCode(vtkErrorCode::NoError);

  if (input->GetNumberOfPoints() == 0 || input->GetNumberOfPolys() + input->GetNumberOfStrips() == 0)
  {
    if (internals.Kept.AreBlocks())
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
    const std::string detail = internals.Kept.Remesher() ? aqr_remesher_message(internals.Kept.Remesher()) : "";
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

  internals.Warnings = WarningsOf(internals.Kept.Remesher(), input, this->LockLines, internals.Locked.size() / 2);
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
  const aqr_remesher* remesher = this->Internals->Kept.Remesher();
  return remesher ? ReportOf(remesher, this->Internals->Warnings) : "{}";
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
