// SPDX-License-Identifier: BSD-3-Clause
// The command line of aqr-remesh.
#ifndef Options_h
#define Options_h

#include <stdexcept>
#include <string>

class vtkAnisotropicQuadRemesher;

struct Options
{
  std::string Input;
  std::string Output;
  std::string Lines;
  std::string Directions;
  std::string Confidence;
  std::string Picture;
  std::string Report;
  bool Summary = false;
  bool Help = false;
  bool Version = false;
};

// What is wrong with the command line, in one sentence.
struct UsageError : std::runtime_error
{
  using std::runtime_error::runtime_error;
};

std::string HelpText();

// Sets the filter's parameters and returns the rest; throws UsageError.
Options ParseOptions(int argc, char** argv, vtkAnisotropicQuadRemesher* filter);

#endif
