// SPDX-License-Identifier: BSD-3-Clause
#include "Files.h"

#include "Announced.h"
#include "Text.h"

#include "vtkAbstractArray.h"
#include "vtkCellArray.h"
#include "vtkFieldData.h"
#include "vtkLogger.h"
#include "vtkNew.h"
#include "vtkOBJReader.h"
#include "vtkOBJWriter.h"
#include "vtkObjectFactory.h"
#include "vtkOutputWindow.h"
#include "vtkPLYReader.h"
#include "vtkPLYWriter.h"
#include "vtkPolyDataReader.h"
#include "vtkPolyDataWriter.h"
#include "vtkSTLReader.h"
#include "vtkSTLWriter.h"
#include "vtkTriangleFilter.h"
#include "vtkXMLPolyDataReader.h"
#include "vtkXMLPolyDataWriter.h"

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

namespace fs = std::filesystem;

namespace
{
//------------------------------------------------------------------------------
class Recorder : public vtkOutputWindow
{
public:
  static Recorder* New();
  vtkTypeMacro(Recorder, vtkOutputWindow);
  void DisplayText(const char* text) override
  {
    const std::string message = text;
    // The executive repeats that an algorithm failed; the algorithm itself has said why.
    if (message.find("returned failure for request") != std::string::npos)
    {
      this->Failed = true;
      return;
    }
    const bool isError = this->GetCurrentMessageType() == vtkOutputWindow::MESSAGE_TYPE_ERROR;
    // Some readers only warn of it, go on, and read through wild pointers or leave memory as it happened to be.
    if (message.find("PLY error reading file") != std::string::npos ||
        (!isError && message.find("Error reading") != std::string::npos))
    {
      this->FirstError = "the file ends too early"; // a reader that catches what is thrown says only that it failed
      throw CutShort(this->FirstError);
    }
    if (message.find("Unable to allocate") != std::string::npos) // some builds of VTK end the process next
    {
      this->FirstError = "there is no memory for what it announces";
      throw CutShort(this->FirstError);
    }
    std::string& kept = isError ? this->FirstError : this->FirstWarning;
    if (kept.empty())
    {
      kept = message;
    }
  }
  std::string FirstError;
  std::string FirstWarning;
  bool Failed = false;
};
vtkStandardNewMacro(Recorder);

//------------------------------------------------------------------------------
// "ERROR: In file, line 1\nvtkClass (0x1): Reason: detail\n\n" becomes "Reason: detail".
std::string Sentence(const std::string& message)
{
  const size_t begin = message.find("): ");
  std::string text = begin == std::string::npos ? message : message.substr(begin + 3);
  std::replace_if(
    text.begin(), text.end(), [](unsigned char c) { return std::iscntrl(c); }, ' ');
  std::replace_if( // what a reader quotes from a binary file
    text.begin(), text.end(), [](unsigned char c) { return c >= 0x80; }, '?');
  const size_t last = text.find_last_not_of(" .");
  return text.substr(0, last == std::string::npos ? 0 : last + 1);
}

//------------------------------------------------------------------------------
std::string Extension(const std::string& file)
{
  std::string extension = fs::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

//------------------------------------------------------------------------------
template <typename ReaderT>
vtkSmartPointer<vtkPolyData> Read(const std::string& file)
{
  vtkNew<ReaderT> reader;
  reader->SetFileName(file.c_str());
  reader->Update();
  return reader->GetOutput();
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> ReadByExtension(const std::string& extension, const std::string& file)
{
  if (extension == ".ply")
  {
    CheckPly(file);
    return Read<vtkPLYReader>(file);
  }
  if (extension == ".obj")
  {
    return Read<vtkOBJReader>(file);
  }
  if (extension == ".stl")
  {
    CheckStl(file);
    return Read<vtkSTLReader>(file);
  }
  if (extension == ".vtk")
  {
    CheckVtkText(file);
    auto surface = Read<vtkPolyDataReader>(file);
    CheckVtk(file, surface->GetNumberOfPolys());
    return surface;
  }
  if (extension == ".vtp")
  {
    CheckVtp(file);
    return Read<vtkXMLPolyDataReader>(file);
  }
  return nullptr;
}

//------------------------------------------------------------------------------
template <typename WriterT>
bool Write(WriterT* writer, const std::string& file, vtkPolyData* surface)
{
  writer->SetFileName(file.c_str());
  writer->SetInputData(surface);
  return writer->Write() != 0 && writer->GetErrorCode() == 0;
}

//------------------------------------------------------------------------------
// Whether a binary .ply file is as long as its header says.
bool IsWholePly(const std::string& file, vtkPolyData* surface)
{
  std::ifstream stream(file, std::ios::binary);
  std::uintmax_t bytes = 0;
  std::uintmax_t items = 0;
  for (std::string line; std::getline(stream, line) && line != "end_header";)
  {
    std::istringstream words(line);
    std::string word;
    std::string type;
    words >> word >> type;
    if (word == "element")
    {
      words >> items;
    }
    else if (word == "property" && type == "list")
    {
      bytes += items + 4 * static_cast<std::uintmax_t>(surface->GetPolys()->GetNumberOfConnectivityIds());
    }
    else if (word == "property")
    {
      bytes += items * (type == "double" ? 8 : type == "uchar" ? 1 : 4);
    }
  }
  std::error_code code;
  return stream && fs::file_size(file, code) == static_cast<std::uintmax_t>(stream.tellg()) + bytes && !code;
}

//------------------------------------------------------------------------------
// Whether a .obj file has all lines of the points and polygons of a surface.
bool IsWholeObj(const std::string& file, vtkPolyData* surface)
{
  std::ifstream stream(file, std::ios::binary);
  vtkIdType points = 0;
  vtkIdType polygons = 0;
  bool ended = false;
  for (std::string line; std::getline(stream, line);)
  {
    ended = !stream.eof(); // the end came after the line's
    points += line.compare(0, 2, "v ") == 0;
    polygons += line.compare(0, 2, "f ") == 0;
  }
  return ended && points == surface->GetNumberOfPoints() && polygons == surface->GetNumberOfPolys();
}

//------------------------------------------------------------------------------
// VTK writes the names of arrays, which in .obj files are those of materials, into XML as they are: "R&D" makes a file
// that nothing reads. The next output may share the arrays, so that they get their names back.
class XmlNames
{
public:
  explicit XmlNames(vtkPolyData* surface)
  {
    for (int type : { vtkDataObject::POINT, vtkDataObject::CELL, vtkDataObject::FIELD })
    {
      vtkFieldData* data = surface->GetAttributesAsFieldData(type);
      for (int i = 0; i < data->GetNumberOfArrays(); ++i)
      {
        vtkAbstractArray* array = data->GetAbstractArray(i);
        const std::string name = array->GetName() ? array->GetName() : "";
        if (this->Names.emplace(array, name).second)
        {
          array->SetName(XmlName(name).c_str());
        }
      }
    }
  }
  ~XmlNames()
  {
    for (const auto& [array, name] : this->Names)
    {
      array->SetName(name.c_str());
    }
  }
  XmlNames(const XmlNames&) = delete;
  XmlNames& operator=(const XmlNames&) = delete;

private:
  std::map<vtkAbstractArray*, std::string> Names;
};

//------------------------------------------------------------------------------
bool WriteByExtension(const std::string& extension, const std::string& file, vtkPolyData* surface)
{
  if (extension == ".vtp")
  {
    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetDataModeToAppended();
    writer->EncodeAppendedDataOff();
    writer->SetCompressorTypeToNone();
    const XmlNames names(surface);
    return Write(writer.Get(), file, surface);
  }
  if (extension == ".vtk")
  {
    vtkNew<vtkPolyDataWriter> writer;
    writer->SetFileTypeToBinary();
    return Write(writer.Get(), file, surface);
  }
  if (extension == ".ply")
  {
    // By itself this writer does not notice that the disk is full; nor does the next.
    vtkNew<vtkPLYWriter> writer;
    return Write(writer.Get(), file, surface) && IsWholePly(file, surface);
  }
  if (extension == ".obj")
  {
    vtkNew<vtkOBJWriter> writer;
    return Write(writer.Get(), file, surface) && IsWholeObj(file, surface);
  }
  vtkNew<vtkTriangleFilter> triangulate;
  triangulate->SetInputData(surface);
  triangulate->Update();
  vtkNew<vtkSTLWriter> writer;
  writer->SetFileTypeToBinary();
  return Write(writer.Get(), file, triangulate->GetOutput());
}

//------------------------------------------------------------------------------
fs::path Folder(const std::string& file)
{
  const fs::path folder = fs::path(file).parent_path();
  return folder.empty() ? fs::path(".") : folder;
}
}

//------------------------------------------------------------------------------
Complaints::Complaints()
{
  vtkLogger::SetStderrVerbosity(vtkLogger::VERBOSITY_OFF);
  vtkNew<Recorder> recorder;
  vtkOutputWindow::SetInstance(recorder);
}

//------------------------------------------------------------------------------
std::string Complaints::TakeError()
{
  auto* recorder = Recorder::SafeDownCast(vtkOutputWindow::GetInstance());
  std::string error;
  std::swap(error, recorder->FirstError);
  if (error.empty() && recorder->Failed)
  {
    error = recorder->FirstWarning.empty() ? "not a valid file" : recorder->FirstWarning;
  }
  recorder->FirstWarning.clear();
  recorder->Failed = false;
  return Sentence(error);
}

//------------------------------------------------------------------------------
vtkSmartPointer<vtkPolyData> ReadSurface(const std::string& file, Complaints& complaints)
{
  std::error_code code;
  if (fs::is_directory(file, code))
  {
    throw FileError(file, "is a folder");
  }
  if (!std::ifstream(file))
  {
    throw FileError(file, std::string("cannot be read: ") + std::strerror(errno));
  }
  if (fs::is_regular_file(file, code) && fs::file_size(file, code) == 0)
  {
    throw FileError(file, "is empty");
  }
  complaints.TakeError();
  vtkSmartPointer<vtkPolyData> surface;
  try
  {
    surface = ReadByExtension(Extension(file), file);
  }
  catch (const CutShort& failure)
  {
    throw FileError(file, std::string("cannot be read: ") + failure.what());
  }
  if (!surface)
  {
    throw FileError(file, "has none of the extensions .ply .obj .stl .vtk .vtp");
  }
  const std::string error = complaints.TakeError();
  if (!error.empty())
  {
    throw FileError(file, "cannot be read: " + error);
  }
  if (surface->GetNumberOfPoints() == 0 || surface->GetNumberOfPolys() + surface->GetNumberOfStrips() == 0)
  {
    throw FileError(file, "holds no polygons, or is not a valid " + Extension(file) + " file");
  }
  return surface;
}

//------------------------------------------------------------------------------
void CheckOutput(const std::string& file, const std::vector<std::string>& extensions)
{
  if (std::find(extensions.begin(), extensions.end(), Extension(file)) == extensions.end())
  {
    std::string list;
    for (const std::string& extension : extensions)
    {
      list += " " + extension;
    }
    throw FileError(file, (extensions.size() > 1 ? "has none of the extensions" : "has not the extension") + list);
  }
  std::error_code code;
  if (fs::is_directory(file, code))
  {
    throw FileError(file, "is a folder");
  }
  if (!fs::is_directory(Folder(file), code))
  {
    throw FileError(file, "cannot be written: its folder does not exist");
  }
  if (access(Folder(file).c_str(), W_OK) != 0)
  {
    throw FileError(file, std::string("cannot be written: ") + std::strerror(errno));
  }
}

//------------------------------------------------------------------------------
OutputFiles::OutputFiles(Complaints& complaints)
  : Errors(complaints)
{
}

//------------------------------------------------------------------------------
OutputFiles::~OutputFiles()
{
  for (const Pending& pending : this->Files)
  {
    std::error_code code;
    fs::remove(pending.Temporary, code);
  }
}

//------------------------------------------------------------------------------
std::string OutputFiles::Temporary(const std::string& file)
{
  const fs::path name = "." + std::to_string(getpid()) + "-" + std::to_string(this->Files.size()) + "-" +
                        fs::path(file).filename().string();
  this->Files.push_back({ (Folder(file) / name).string(), file });
  return this->Files.back().Temporary;
}

//------------------------------------------------------------------------------
void OutputFiles::WriteSurface(const std::string& file, vtkPolyData* surface)
{
  this->Errors.TakeError();
  const bool written = WriteByExtension(Extension(file), this->Temporary(file), surface);
  // VTK's words for it differ from writer to writer, and some name the temporary file.
  if (const std::string error = this->Errors.TakeError(); !written || !error.empty())
  {
    const bool other = written && error.find("disk space") == std::string::npos;
    throw FileError(file, "cannot be written: " + (other ? error : "the disk may be full"));
  }
}

//------------------------------------------------------------------------------
void OutputFiles::WriteText(const std::string& file, const std::string& text)
{
  std::ofstream stream(this->Temporary(file));
  stream << text;
  stream.close();
  if (!stream)
  {
    throw FileError(file, std::string("cannot be written: ") + std::strerror(errno));
  }
}

//------------------------------------------------------------------------------
void OutputFiles::Commit()
{
  for (const Pending& pending : this->Files)
  {
    std::error_code code;
    fs::rename(pending.Temporary, pending.File, code);
    if (code)
    {
      throw FileError(pending.File, "cannot be written: " + code.message());
    }
  }
  this->Files.clear();
}
