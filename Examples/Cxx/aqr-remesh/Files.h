// SPDX-License-Identifier: BSD-3-Clause
// Reading and writing surfaces by extension, with one sentence for whatever goes wrong.
#ifndef Files_h
#define Files_h

#include "vtkPolyData.h"
#include "vtkSmartPointer.h"

#include <stdexcept>
#include <string>
#include <vector>

// A file that cannot be used, and why.
struct FileError : std::runtime_error
{
  FileError(const std::string& file, const std::string& reason)
    : std::runtime_error(file + ": " + reason)
  {
  }
};

// Keeps what VTK would print; made before the first VTK call that may complain.
class Complaints
{
public:
  Complaints();
  // The first error since the last call as a plain sentence; empty when there was none.
  std::string TakeError();
};

vtkSmartPointer<vtkPolyData> ReadSurface(const std::string& file, Complaints& complaints);

// Throws FileError unless the file has one of the extensions and can be created where it should be.
void CheckOutput(const std::string& file, const std::vector<std::string>& extensions);

// Output files appear under their own names at Commit(), once all are written; those left without a name go with this.
// Should one not get its name then, those before it have theirs.
class OutputFiles
{
public:
  explicit OutputFiles(Complaints& complaints);
  ~OutputFiles();
  OutputFiles(const OutputFiles&) = delete;
  OutputFiles& operator=(const OutputFiles&) = delete;

  void WriteSurface(const std::string& file, vtkPolyData* surface);
  void WriteText(const std::string& file, const std::string& text);
  // A name in the file's own folder to write to.
  std::string Temporary(const std::string& file);
  void Commit();

private:
  struct Pending
  {
    std::string Temporary;
    std::string File;
  };
  Complaints& Errors;
  std::vector<Pending> Files;
};

#endif
