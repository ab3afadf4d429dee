// SPDX-License-Identifier: BSD-3-Clause
// Names that come from outside, as files of other kinds hold them. What is not UTF-8 is taken for Latin-1, as old .obj
// files are.
#ifndef Text_h
#define Text_h

#include <string>

// As an attribute of XML.
std::string XmlName(const std::string& name);

// As a string of JSON, with its quotes.
std::string JsonText(const std::string& text);

#endif
