// SPDX-License-Identifier: BSD-3-Clause
// A picture of a mesh that shows what its faces are.
#ifndef Picture_h
#define Picture_h

#include <string>

class vtkPolyData;

// Whether an X server answers; VTK ends the process where none does.
bool HasDisplay();

// Quads light, triangles blue, larger polygons orange, edges dark, interior points without four edges
// as red dots. False when the file could not be written.
bool WritePicture(vtkPolyData* mesh, const std::string& file);

#endif
