// SPDX-License-Identifier: BSD-3-Clause
// What is told of a run.
#ifndef RunReport_h
#define RunReport_h

#include "aqr.h"

#include <string>
#include <vector>

class vtkPolyData;

// Sentences about everything that was not as it should be.
std::vector<std::string> WarningsOf(
  const aqr_remesher* remesher, vtkPolyData* input, bool lockLines, size_t lockedEdges);

// Counts, warnings and stages as JSON.
std::string ReportOf(const aqr_remesher* remesher, const std::vector<std::string>& warnings);

#endif
