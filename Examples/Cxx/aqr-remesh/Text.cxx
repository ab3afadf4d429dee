// SPDX-License-Identifier: BSD-3-Clause
#include "Text.h"

#include <algorithm>
#include <cctype>
#include <iomanip>
#include <sstream>

namespace
{
//------------------------------------------------------------------------------
// Bytes of the UTF-8 sequence at a position, 0 where none begins there (Unicode 15, table 3-7).
size_t SequenceAt(const std::string& text, size_t at)
{
  const auto byte = [&](size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0; };
  const int lead = byte(at);
  const size_t n = lead < 0x80 ? 1 : lead < 0xC2 ? 0 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : lead < 0xF5 ? 4 : 0;
  const int least = lead == 0xE0 ? 0xA0 : lead == 0xF0 ? 0x90 : 0x80;
  const int most = lead == 0xED ? 0x9F : lead == 0xF4 ? 0x8F : 0xBF;
  if (n > 1 && (byte(at + 1) < least || byte(at + 1) > most))
  {
    return 0;
  }
  for (size_t i = 2; i < n; ++i)
  {
    if ((byte(at + i) & 0xC0) != 0x80)
    {
      return 0;
    }
  }
  return n;
}
}

//------------------------------------------------------------------------------
std::string XmlName(const std::string& name)
{
  std::ostringstream text;
  for (size_t i = 0, n = 0; i < name.size(); i += std::max<size_t>(n, 1))
  {
    n = SequenceAt(name, i);
    const auto c = static_cast<unsigned char>(name[i]);
    if (n == 0 || c == '&' || c == '<' || c == '"')
    {
      text << "&#" << static_cast<int>(c) << ';';
    }
    else
    {
      text << (std::iscntrl(c) ? " " : name.substr(i, n));
    }
  }
  return text.str();
}

//------------------------------------------------------------------------------
std::string JsonText(const std::string& text)
{
  std::ostringstream quoted;
  quoted << '"' << std::hex << std::setfill('0');
  for (size_t i = 0, n = 0; i < text.size(); i += std::max<size_t>(n, 1))
  {
    n = SequenceAt(text, i);
    const auto c = static_cast<unsigned char>(text[i]);
    if (n == 0 || std::iscntrl(c))
    {
      quoted << "\\u" << std::setw(4) << static_cast<int>(c);
    }
    else
    {
      quoted << (c == '"' || c == '\\' ? "\\" : "") << text.substr(i, n);
    }
  }
  quoted << '"';
  return quoted.str();
}
