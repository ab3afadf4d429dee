// SPDX-License-Identifier: BSD-3-Clause
// Whether files hold what their headers announce, where VTK's readers take what they find or read beyond it.
#ifndef Announced_h
#define Announced_h

#include <stdexcept>
#include <string>

// A file that ends too early, or holds something else than it says.
struct CutShort : std::runtime_error
{
  using std::runtime_error::runtime_error;
};

// vtkPLYReader ends the whole process where an ASCII file has too few lines, and reads through wild pointers where a
// number of vertices or faces is not the file's.
void CheckPly(const std::string& file);

// vtkSTLReader takes as many triangles as there are, without a word.
void CheckStl(const std::string& file);

// vtkPolyDataReader of VTK 9.1 reads through wild pointers where a text file before version 5 has fewer polygons, lines
// or numbers of them than it says.
void CheckVtkText(const std::string& file);

// vtkPolyDataReader passes over the number of polygons in files before version 5, which count what is in them
// otherwise.
void CheckVtk(const std::string& file, long long polygons);

// vtkXMLPolyDataReader reads through wild pointers where a number of points is below 0.
void CheckVtp(const std::string& file);

#endif
