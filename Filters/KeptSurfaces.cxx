// SPDX-License-Identifier: BSD-3-Clause
#include "KeptSurfaces.h"

#include <algorithm>
#include <iterator>

//------------------------------------------------------------------------------
FieldSources::FieldSources(vtkPolyData* input, const aqr_field_view& field)
  : PointData(input->GetPointData())
  , CellData(input->GetCellData())
  , Time(std::max(PointData->GetMTime(), CellData->GetMTime()))
  , Precision(input->GetPoints()->GetDataType())
  , Revision(field.revision)
{
}

//------------------------------------------------------------------------------
bool FieldSources::operator==(const FieldSources& other) const
{
  return this->PointData == other.PointData && this->CellData == other.CellData && this->Time == other.Time &&
         this->Precision == other.Precision && this->Revision == other.Revision;
}

//------------------------------------------------------------------------------
KeptSurface::~KeptSurface()
{
  aqr_remesher_free(this->Remesher);
}

//------------------------------------------------------------------------------
aqr_status KeptSurface::SetHooks(const aqr_hooks& hooks)
{
  if (this->Remesher)
  {
    aqr_remesher_set_hooks(this->Remesher, &hooks);
    return AQR_OK;
  }
  return aqr_remesher_new(&hooks, &this->Remesher);
}

//------------------------------------------------------------------------------
void KeptSurfaces::BeginBlocks(vtkAlgorithmOutput* connection)
{
  if (this->TurnIsUsed)
  {
    this->Surfaces.remove_if([&](const KeptSurface& kept) { return kept.Turn != this->Turn; });
    this->Turn++;
    this->TurnIsUsed = false;
  }
  this->Blocks = connection;
}

//------------------------------------------------------------------------------
aqr_status KeptSurfaces::SetInput(vtkPolyData* input, const std::vector<int64_t>& locked, const aqr_hooks& hooks)
{
  const SurfaceTimes times = TimesOf(input);
  const auto unchanged = [&](const KeptSurface& kept)
  { return kept.Points && kept.Times == times && kept.Locked == locked; };
  auto found = std::find_if(this->Surfaces.begin(), this->Surfaces.end(), unchanged);
  SurfaceDigest digest = {};
  if (found == this->Surfaces.end())
  {
    digest = DigestOf(input);
    found = std::find_if(this->Surfaces.begin(), this->Surfaces.end(),
      [&](const KeptSurface& kept) { return kept.Points && kept.Digest == digest && kept.Locked == locked; });
  }
  const bool known = found != this->Surfaces.end();
  if (known)
  {
    this->Surfaces.splice(this->Surfaces.begin(), this->Surfaces, found);
  }
  else if (this->Surfaces.empty() || this->InBlocks)
  {
    this->Surfaces.emplace_front();
  }
  else
  {
    this->Surfaces.splice(this->Surfaces.begin(), this->Surfaces, std::prev(this->Surfaces.end()));
  }
  if (!this->InBlocks)
  {
    this->Surfaces.resize(1);
  }
  KeptSurface& kept = this->Surfaces.front();
  kept.Turn = this->Turn;
  this->TurnIsUsed = true;
  aqr_status status = kept.SetHooks(hooks);
  if (status == AQR_OK && !known)
  {
    kept.Points = nullptr;
    status = kept.Surface.Give(input, locked, kept.Remesher);
    kept.Digest = digest;
    kept.Locked = locked;
  }
  if (status == AQR_OK)
  {
    kept.Points = input->GetPoints();
    kept.Times = times;
  }
  return status;
}
