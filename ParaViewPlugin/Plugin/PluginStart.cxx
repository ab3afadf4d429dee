// SPDX-License-Identifier: BSD-3-Clause
#include "PluginStart.h"

#include "vtkPVVersion.h"
#include "vtkSMProxyManager.h"
#include "vtkSMSettings.h"
#include "vtkSMTransferFunctionPresets.h"
#include "vtkSetGet.h"

namespace
{
// Blue and red as the principal directions are drawn everywhere in this project.
const char* const LineTypes = R"({
  "Name": "Types of integrated lines",
  "Creator": "Anisotropic Quad Remesher",
  "Annotations": ["0", "Minimum curvature", "1", "Maximum curvature", "2", "Boundary", "3", "Feature"],
  "IndexedColors": [0.16, 0.38, 0.79, 0.84, 0.19, 0.15, 0.10, 0.55, 0.20, 0.95, 0.65, 0.10]
})";
const char* const Presets = R"({ "standard_presets": { "LineType": "Types of integrated lines" } })";
}

//------------------------------------------------------------------------------
void StartAnisotropicQuadRemesherPlugin()
{
  // Asked of the library that ParaView itself runs with.
  const int major = vtkSMProxyManager::GetVersionMajor();
  const int minor = vtkSMProxyManager::GetVersionMinor();
  if (major != PARAVIEW_VERSION_MAJOR || minor != PARAVIEW_VERSION_MINOR)
  {
    vtkGenericWarningMacro(
      "AnisotropicQuadRemesherPlugin was built for ParaView " PARAVIEW_VERSION ", and this is ParaView "
      << major << "." << minor
      << ". Build the plugin against this ParaView; with the present one the filter may crash.");
    return;
  }
  auto* presets = vtkSMTransferFunctionPresets::GetInstance();
  if (!presets->HasPreset("Types of integrated lines"))
  {
    presets->AddPreset("Types of integrated lines", LineTypes);
  }
  vtkSMSettings::GetInstance()->AddCollectionFromString(Presets, 0.0);
}
