// SPDX-License-Identifier: BSD-3-Clause
#include "Announced.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <vector>

namespace
{
const char* const TooEarly = "the file ends too early";
const char* const TooMuch = "it holds more than its header announces";

//------------------------------------------------------------------------------
struct Type
{
  size_t Bytes;
  bool IsWhole, IsSigned;
};

struct Property
{
  bool IsList;
  Type Count, Value; // Count: of a list
};

struct Element
{
  std::uint64_t Items = 0;
  std::vector<Property> Properties;
};

struct Header
{
  bool IsText = false, IsBigEndian = false;
  std::vector<Element> Elements;
};

//------------------------------------------------------------------------------
Type TypeOf(const std::string& name)
{
  static const std::map<std::string, Type> types = { { "char", { 1, true, true } }, { "int8", { 1, true, true } },
    { "uchar", { 1, true, false } }, { "uint8", { 1, true, false } }, { "short", { 2, true, true } },
    { "int16", { 2, true, true } }, { "ushort", { 2, true, false } }, { "uint16", { 2, true, false } },
    { "int", { 4, true, true } }, { "int32", { 4, true, true } }, { "uint", { 4, true, false } },
    { "uint32", { 4, true, false } }, { "float", { 4, false, true } }, { "float32", { 4, false, true } },
    { "double", { 8, false, true } }, { "float64", { 8, false, true } } };
  const auto found = types.find(name);
  if (found == types.end())
  {
    throw CutShort("its header names a type \"" + name + "\", which .ply files do not have");
  }
  return found->second;
}

//------------------------------------------------------------------------------
// A whole number that is not negative.
std::uint64_t Whole(const std::string& text)
{
  const bool digits = !text.empty() && text.size() < 19 &&
                      std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isdigit(c) != 0; });
  if (!digits)
  {
    throw CutShort("\"" + text + "\" is no number of items");
  }
  return std::strtoull(text.c_str(), nullptr, 10);
}

//------------------------------------------------------------------------------
Header ReadHeader(std::istream& stream)
{
  Header header;
  std::string line;
  while (std::getline(stream, line) && line.compare(0, 10, "end_header") != 0)
  {
    std::istringstream words(line);
    std::string word;
    std::string type;
    std::string count;
    words >> word >> type;
    if (word == "format")
    {
      header.IsText = type == "ascii";
      header.IsBigEndian = type == "binary_big_endian";
    }
    else if (word == "element")
    {
      words >> count;
      header.Elements.emplace_back();
      header.Elements.back().Items = Whole(count);
    }
    else if (word == "property" && header.Elements.empty())
    {
      throw CutShort("its header names a property before any element");
    }
    else if (word == "property" && type == "list")
    {
      words >> count >> type;
      const Type counts = TypeOf(count);
      if (!counts.IsWhole)
      {
        throw CutShort("its header counts a list by numbers that are not whole");
      }
      header.Elements.back().Properties.push_back({ true, counts, TypeOf(type) });
    }
    else if (word == "property")
    {
      header.Elements.back().Properties.push_back({ false, {}, TypeOf(type) });
    }
  }
  if (!stream)
  {
    throw CutShort("it has no .ply header");
  }
  return header;
}

//------------------------------------------------------------------------------
// Every item is a line.
void CheckText(std::istream& stream, const Header& header)
{
  std::string line;
  std::string word;
  const auto next = [&]
  {
    while (std::getline(stream, line))
    {
      if (line.find_first_not_of(" \t\r") != std::string::npos)
      {
        return true;
      }
    }
    return false;
  };
  for (const Element& element : header.Elements)
  {
    for (std::uint64_t i = 0; i < element.Items; ++i)
    {
      if (!next())
      {
        throw CutShort(TooEarly);
      }
      std::istringstream words(line);
      for (const Property& property : element.Properties)
      {
        words >> word;
        for (std::uint64_t left = words && property.IsList ? Whole(word) : 0; left > 0 && words; --left)
        {
          words >> word;
        }
        if (!words)
        {
          throw CutShort(stream.eof()
                           ? TooEarly
                           : "a line has fewer numbers than its header announces: \"" + line.substr(0, 40) + "\"");
        }
      }
    }
  }
  if (next())
  {
    throw CutShort(TooMuch);
  }
}

//------------------------------------------------------------------------------
void CheckBinary(std::istream& stream, const Header& header, std::uint64_t left)
{
  const auto skip = [&](std::uint64_t items, std::uint64_t bytes)
  {
    if (items > left / bytes)
    {
      throw CutShort(TooEarly);
    }
    stream.ignore(static_cast<std::streamsize>(items * bytes));
    left -= items * bytes;
  };
  for (const Element& element : header.Elements)
  {
    for (std::uint64_t i = 0; i < element.Items && !element.Properties.empty(); ++i)
    {
      for (const Property& property : element.Properties)
      {
        if (!property.IsList)
        {
          skip(1, property.Value.Bytes);
          continue;
        }
        std::array<char, 4> bytes = {};
        const size_t n = property.Count.Bytes;
        if (n > left || !stream.read(bytes.data(), static_cast<std::streamsize>(n)))
        {
          throw CutShort(TooEarly);
        }
        left -= n;
        std::uint64_t count = 0;
        for (size_t k = 0; k < n; ++k)
        {
          count = 256 * count + static_cast<unsigned char>(bytes[header.IsBigEndian ? k : n - 1 - k]);
        }
        if (property.Count.IsSigned && count >> (8 * n - 1))
        {
          throw CutShort("a list has fewer than no items");
        }
        skip(count, property.Value.Bytes);
      }
    }
  }
  if (left > 0)
  {
    throw CutShort(TooMuch);
  }
}

//------------------------------------------------------------------------------
// Of a .vtk file; 0 where its first line names none.
int VersionOf(std::istream& stream)
{
  std::string line;
  std::getline(stream, line);
  const size_t version = line.find("Version ");
  return version == std::string::npos ? 0 : std::atoi(line.c_str() + version + 8);
}

//------------------------------------------------------------------------------
// Lists of cells, each the number of its points and these points.
void CheckCells(std::istream& stream, std::uint64_t cells, std::uint64_t numbers)
{
  std::uint64_t found = 0;
  long long number = 0;
  for (std::uint64_t i = 0; i < cells; ++i)
  {
    stream >> number;
    for (long long left = number; left > 0 && stream; --left)
    {
      stream >> number;
      ++found;
    }
    if (!stream)
    {
      throw CutShort(TooEarly);
    }
    ++found;
  }
  if (found != numbers)
  {
    throw CutShort("it announces " + std::to_string(numbers) + " numbers, and holds " + std::to_string(found));
  }
}

//------------------------------------------------------------------------------
std::uint64_t SizeOf(const std::string& file)
{
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(file, code);
  return code ? 0 : size;
}
}

//------------------------------------------------------------------------------
void CheckPly(const std::string& file)
{
  std::ifstream stream(file, std::ios::binary);
  const Header header = ReadHeader(stream);
  if (header.IsText)
  {
    CheckText(stream, header);
  }
  else
  {
    // No place is told where the header's last line ends with the file.
    const auto at = static_cast<std::streamoff>(stream.tellg());
    const std::uint64_t size = SizeOf(file);
    const std::uint64_t begin = at < 0 ? size : static_cast<std::uint64_t>(at);
    CheckBinary(stream, header, begin < size ? size - begin : 0);
  }
}

//------------------------------------------------------------------------------
void CheckStl(const std::string& file)
{
  constexpr std::streamsize looked = 256; // by so many bytes the reader tells text from binary
  constexpr std::uint64_t header = 84;
  constexpr std::uint64_t triangle = 50;
  std::ifstream stream(file, std::ios::binary);
  std::array<char, looked> begin = {};
  stream.read(begin.data(), looked);
  const std::streamsize n = stream.gcount();
  const auto text = std::count_if(begin.begin(), begin.begin() + n,
    [](unsigned char c) { return (c >= 0x20 && c <= 0x7f) || c == '\n' || c == '\r' || c == '\t'; });
  if (static_cast<double>(n - text) < 0.05 * static_cast<double>(n))
  {
    stream.clear();
    stream.seekg(0);
    std::string last;
    for (std::string line; std::getline(stream, line);)
    {
      const size_t first = line.find_first_not_of(" \t\r");
      last = first == std::string::npos ? last : line.substr(first, 8);
    }
    std::transform(last.begin(), last.end(), last.begin(), [](unsigned char c) { return std::tolower(c); });
    if (last != "endsolid")
    {
      throw CutShort(TooEarly);
    }
    return;
  }
  const std::uint64_t size = SizeOf(file);
  if (size < header)
  {
    throw CutShort(TooEarly);
  }
  std::uint64_t announced = 0;
  for (size_t k = 4; k-- > 0;)
  {
    announced = 256 * announced + static_cast<unsigned char>(begin[80 + k]);
  }
  const std::uint64_t held = (size - header) / triangle;
  if (held != announced)
  {
    throw CutShort(held < announced ? TooEarly : TooMuch);
  }
}

//------------------------------------------------------------------------------
void CheckVtkText(const std::string& file)
{
  std::ifstream stream(file, std::ios::binary);
  const int version = VersionOf(stream);
  std::string line;
  std::getline(stream, line); // a title
  std::getline(stream, line);
  if (version == 0 || version >= 5 || line.compare(0, 5, "ASCII") != 0)
  {
    return;
  }
  while (std::getline(stream, line))
  {
    std::istringstream words(line);
    std::string word;
    std::string cells;
    std::string numbers;
    words >> word >> cells >> numbers;
    if (word == "POLYGONS" || word == "TRIANGLE_STRIPS" || word == "LINES" || word == "VERTICES")
    {
      CheckCells(stream, Whole(cells), Whole(numbers));
    }
  }
}

//------------------------------------------------------------------------------
void CheckVtk(const std::string& file, long long polygons)
{
  std::ifstream stream(file, std::ios::binary);
  const int version = VersionOf(stream);
  if (version == 0 || version >= 5)
  {
    return;
  }
  for (std::string line; std::getline(stream, line);)
  {
    std::istringstream words(line);
    std::string word;
    std::string count;
    words >> word >> count;
    if (word == "POLYGONS" && Whole(count) != static_cast<std::uint64_t>(polygons))
    {
      throw CutShort("it announces " + count + " polygons, and holds " + std::to_string(polygons));
    }
    if (word == "POLYGONS")
    {
      return;
    }
  }
}

//------------------------------------------------------------------------------
void CheckVtp(const std::string& file)
{
  std::ifstream stream(file, std::ios::binary);
  for (std::string line; std::getline(stream, line) && line.find("<AppendedData") == std::string::npos;)
  {
    for (const std::string name : { "Points", "Verts", "Lines", "Strips", "Polys" })
    {
      const std::string before = "NumberOf" + name + "=";
      const size_t begin = line.find(before);
      if (begin != std::string::npos && begin + before.size() + 1 < line.size())
      {
        const size_t number = begin + before.size() + 1;
        Whole(line.substr(number, line.find(line[number - 1], number) - number));
      }
    }
  }
}
