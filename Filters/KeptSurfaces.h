// SPDX-License-Identifier: BSD-3-Clause
// Surfaces with the stages computed for them, so that what comes again is not computed again.
#ifndef KeptSurfaces_h
#define KeptSurfaces_h

#include "InputSurface.h"
#include "aqr.h"

#include "vtkCellData.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <list>
#include <vector>

class vtkAlgorithmOutput;

// What the ports of the field are made of: where nothing of it changes they serve again.
struct FieldSources
{
  vtkSmartPointer<vtkPointData> PointData; // kept, as all objects here, so that no other can take its address
  vtkSmartPointer<vtkCellData> CellData;
  vtkMTimeType Time = 0;
  int Precision = 0;
  uint64_t Revision = 0;

  FieldSources() = default;
  FieldSources(vtkPolyData* input, const aqr_field_view& field);
  bool operator==(const FieldSources& other) const;
};

// One surface and the stages computed for it.
struct KeptSurface
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

  KeptSurface() = default;
  KeptSurface(const KeptSurface&) = delete;
  void operator=(const KeptSurface&) = delete;
  ~KeptSurface();

  aqr_status SetHooks(const aqr_hooks& hooks);
};

class KeptSurfaces
{
public:
  // The executive runs a filter for polygonal data once for each block of a composite data set, after it has
  // asked for the whole. The surfaces of the last turn are kept, since the next brings them again.
  void BeginBlocks(vtkAlgorithmOutput* connection);
  // Before each run: whether its surface is a block tells the connection that it comes over.
  void Begin(vtkAlgorithmOutput* connection) { this->InBlocks = this->Blocks && this->Blocks == connection; }
  bool AreBlocks() const { return this->InBlocks; }

  // Makes this surface current where it is kept, or else hands it to the remesher that is longest unused.
  aqr_status SetInput(vtkPolyData* input, const std::vector<int64_t>& locked, const aqr_hooks& hooks);

  aqr_remesher* Remesher() const { return this->Surfaces.empty() ? nullptr : this->Surfaces.front().Remesher; }
  const InputSurface& Surface() const { return this->Surfaces.front().Surface; }
  KeptSurface& Current() { return this->Surfaces.front(); }

private:
  std::list<KeptSurface> Surfaces; // the current one first
  bool InBlocks = false;
  vtkAlgorithmOutput* Blocks = nullptr; // only compared: the connection that last had a composite data set
  unsigned long Turn = 0;
  bool TurnIsUsed = false;
};

#endif
