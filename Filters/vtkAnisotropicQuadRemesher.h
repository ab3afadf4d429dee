// SPDX-License-Identifier: BSD-3-Clause
/**
 * @class   vtkAnisotropicQuadRemesher
 * @brief   remesh a surface with quads aligned to its principal curvatures
 *
 * vtkAnisotropicQuadRemesher replaces a polygonal surface by a mesh of mostly quadrilaterals whose
 * edges follow the lines of principal curvature, and whose sides are as long as the curvature
 * across them allows. It implements M. Marinov and L. Kobbelt, "Direct Anisotropic Quad-Dominant
 * Remeshing", Pacific Graphics 2004, called "the paper" below.
 *
 * The input may hold any polygons and triangle strips; they are triangulated. Vertices are passed
 * over, and lines but for what LockLines makes of them. Defects (degenerate or duplicate triangles, non-manifold edges
 * and points, inconsistent orientation) are repaired on a copy, and one warning says what was done.
 *
 * The four output ports:
 * - 0 Remeshed: the quad-dominant surface. Floating-point point arrays of the input are
 *   interpolated, other point arrays are taken from the nearest input point, cell arrays from a
 *   cell below the new face. Added: point arrays `Normals` (of the input surface; not active, so that
 *   creases stay sharp) and `PointKind`
 *   (0 interior, 1 boundary, 2 feature, 3 corner); cell arrays `NumberOfSides` and `SourceCellId`.
 * - 1 PrincipalDirections: the cleaned and triangulated input with point arrays `MinDirection`,
 *   `MaxDirection` (unit tangent vectors), `MinCurvature` and `MaxCurvature` (signed, one over the
 *   input's unit of length, positive on a sphere with outward normals) and `Normals`.
 * - 2 Confidence: the same surface with `Confidence` in [0,1], per point and per triangle (paper,
 *   section 4.1).
 * - 3 IntegratedLines: the traced lines as polylines. Cell arrays `LineType` (0 minimum, 1 maximum,
 *   2 boundary, 3 feature), `LineId`, `StartReason` and `EndReason` (see EndReasons); point arrays
 *   `Curvature` (across the line), `ArcLength`, `SourceCellId` and `Isotropic`.
 *
 * Stages are cached: after a change of the density only the stages that read it run again; the
 * curvature and the direction field are computed again only when the input or one of their own
 * parameters changed, or the radius of averaging with the density (SetCurvatureRadius). The result
 * does not depend on the number of threads.
 *
 * After an error all outputs are empty, GetErrorCode() is vtkErrorCode::UserError plus the value of
 * aqr_status (see aqr.h), and the next good Update() works. An abort leaves all outputs empty.
 *
 * @sa
 * vtkQuadricDecimation vtkQuadricClustering vtkCurvatures
 */

#ifndef vtkAnisotropicQuadRemesher_h
#define vtkAnisotropicQuadRemesher_h

#include "vtkAnisotropicQuadRemesherModule.h" // For export macro
#include "vtkPolyDataAlgorithm.h"

#include <memory> // For std::unique_ptr
#include <string> // For GetReport

class VTKANISOTROPICQUADREMESHER_EXPORT vtkAnisotropicQuadRemesher : public vtkPolyDataAlgorithm
{
public:
  /** A filter with every parameter at its default. */
  static vtkAnisotropicQuadRemesher* New();
  vtkTypeMacro(vtkAnisotropicQuadRemesher, vtkPolyDataAlgorithm);
  /** Prints every parameter. */
  void PrintSelf(ostream& os, vtkIndent indent) override;
  /** As the superclass; blocks of a composite data set keep the stages computed for each of them. */
  vtkTypeBool ProcessRequest(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  /** The output ports. */
  enum OutputPorts
  {
    REMESHED = 0,
    PRINCIPAL_DIRECTIONS = 1,
    CONFIDENCE = 2,
    INTEGRATED_LINES = 3
  };

  /** What asks for the density of the output. */
  enum DensityModes
  {
    TOLERANCE = 0,
    NUMBER_OF_POINTS = 1
  };

  /** Values of the cell array `LineType` of port 3. */
  enum LineTypes
  {
    MINIMUM_LINE = 0,
    MAXIMUM_LINE = 1,
    BOUNDARY_LINE = 2,
    FEATURE_LINE = 3
  };

  /** Values of the cell arrays `StartReason` and `EndReason` of port 3: why a line stops there. */
  enum EndReasons
  {
    END_LOOP = 0,      ///< the line is closed on itself
    END_BOUNDARY = 1,  ///< reached the boundary of the surface
    END_FEATURE = 2,   ///< reached a feature line
    END_PROXIMITY = 3, ///< too near to another line of its type
    END_SELF = 4,      ///< too near to its own tail
    END_LENGTH = 5,    ///< the cap on its length
    END_CORNER = 6,    ///< a node of the feature graph
    END_CUT = 7        ///< a line drawn only to keep the topology
  };

  ///@{
  /**
   * Whether the density follows from Tolerance or from TargetNumberOfPoints. Default: TOLERANCE.
   */
  vtkSetClampMacro(DensityMode, int, TOLERANCE, NUMBER_OF_POINTS);
  vtkGetMacro(DensityMode, int);
  void SetDensityModeToTolerance() { this->SetDensityMode(TOLERANCE); }
  void SetDensityModeToNumberOfPoints() { this->SetDensityMode(NUMBER_OF_POINTS); }
  ///@}

  ///@{
  /**
   * How far a chord between two neighbouring lines may depart from the surface, as a fraction of
   * the diagonal of the input's bounding box. Smaller gives more points. Read when DensityMode is
   * TOLERANCE. Range [1e-7, 0.1], default 0.0005.
   */
  vtkSetClampMacro(Tolerance, double, 1e-7, 0.1);
  vtkGetMacro(Tolerance, double);
  ///@}

  ///@{
  /**
   * Number of points of the remeshed surface, met within 5 percent where the input can carry it.
   * Read when DensityMode is NUMBER_OF_POINTS. Range [4, 2147483647], default 5000.
   */
  vtkSetClampMacro(TargetNumberOfPoints, vtkIdType, 4, 2147483647);
  vtkGetMacro(TargetNumberOfPoints, vtkIdType);
  ///@}

  ///@{
  /**
   * Multiply the number of points per area by a point array of the input, which must be greater
   * than zero everywhere; factors beyond 1e-6 and 1e6 count as those. With NUMBER_OF_POINTS only
   * what one place has against another counts. Select it with SetInputArrayToProcess(0, 0, 0,
   * vtkDataObject::FIELD_ASSOCIATION_POINTS, name). Default: off.
   */
  vtkSetMacro(UseDensityArray, bool);
  vtkGetMacro(UseDensityArray, bool);
  vtkBooleanMacro(UseDensityArray, bool);
  ///@}

  ///@{
  /**
   * Radius of the ball over which curvature tensors are averaged, as a fraction of the diagonal of
   * the input's bounding box. Larger smooths noise and small detail away; where the ball is
   * smaller than the input's edges it grows. It follows the density: where the points of the output
   * are to lie closer than 1/120 of the diagonal half of this radius is taken, closer than 1/240 a
   * quarter. Range [0, 0.2], default 0.01 (paper, section 2).
   */
  vtkSetClampMacro(CurvatureRadius, double, 0.0, 0.2);
  vtkGetMacro(CurvatureRadius, double);
  ///@}

  ///@{
  /**
   * How often the tensor field is smoothed, weighted by its confidence. Range [0, 1000], default 5
   * (paper, section 4.1).
   */
  vtkSetClampMacro(SmoothingIterations, int, 0, 1000);
  vtkGetMacro(SmoothingIterations, int);
  ///@}

  ///@{
  /**
   * Faces in which the directions at the corners differ by more than this angle, in degrees, count
   * as isotropic: lines cross them straight on. Range [0, 90], default 30 (paper, section 4.1).
   */
  vtkSetClampMacro(ConfidenceAngle, double, 0.0, 90.0);
  vtkGetMacro(ConfidenceAngle, double);
  ///@}

  ///@{
  /**
   * Whether creases of the input become lines, so that they stay edges of the output. Default: on
   * (paper, section 3). Where they would take more than a quarter of a target number of points, or three
   * quarters where the faces between them are flat, those that bend the surface least are given up, with a warning.
   * Locked edges never are.
   */
  vtkSetMacro(FeatureLines, bool);
  vtkGetMacro(FeatureLines, bool);
  vtkBooleanMacro(FeatureLines, bool);
  ///@}

  ///@{
  /**
   * An edge is a crease where its two faces depart from flat by more than this angle, in degrees.
   * Range [0.1, 180], default 40.
   */
  vtkSetClampMacro(FeatureAngle, double, 0.1, 180.0);
  vtkGetMacro(FeatureAngle, double);
  ///@}

  ///@{
  /**
   * Whether the loops of the boundary become lines; when off, the border may be cut coarsely.
   * Default: on (paper, section 3).
   */
  vtkSetMacro(BoundaryLines, bool);
  vtkGetMacro(BoundaryLines, bool);
  vtkBooleanMacro(BoundaryLines, bool);
  ///@}

  ///@{
  /**
   * Whether the lines and polylines of the input stay edges of the output, as creases do, whatever
   * the angle of the surface there. Each piece must run along an edge of the input's polygons, between
   * points of theirs or points at the same places; a warning counts those that do not. Default: off.
   */
  vtkSetMacro(LockLines, bool);
  vtkGetMacro(LockLines, bool);
  vtkBooleanMacro(LockLines, bool);
  ///@}

  ///@{
  /**
   * With LockLines: of the lines only those where a cell array of the input is not zero. Select it with
   * SetInputArrayToProcess(1, 0, 0, vtkDataObject::FIELD_ASSOCIATION_CELLS, name). Default: off.
   */
  vtkSetMacro(UseLockArray, bool);
  vtkGetMacro(UseLockArray, bool);
  vtkBooleanMacro(UseLockArray, bool);
  ///@}

  ///@{
  /**
   * Neighbouring lines are meant to be no farther apart than this fraction of the diagonal of the
   * input's bounding box, however flat the surface (paper, section 3.2). With few target points flat places
   * leave more of them to curved ones: the bound does not hold below 2.2 times the spacing that would spread
   * the points evenly. Range [0.0001, 1], default 0.05.
   */
  vtkSetClampMacro(LargestSpacing, double, 1e-4, 1.0);
  vtkGetMacro(LargestSpacing, double);
  ///@}

  ///@{
  /**
   * How far faces are stretched where the two principal curvatures differ: 1 spaces the lines of each
   * family by their own curvature, 0 gives squares, as fine as the larger curvature asks for. Range
   * [0, 1], default 1.
   */
  vtkSetClampMacro(Anisotropy, double, 0.0, 1.0);
  vtkGetMacro(Anisotropy, double);
  ///@}

  ///@{
  /**
   * How far the density follows the curvature: 1 in full, 0 gives the same number of points per area
   * everywhere, that of the mean curvature. Range [0, 1], default 1.
   */
  vtkSetClampMacro(Adaptivity, double, 0.0, 1.0);
  vtkGetMacro(Adaptivity, double);
  ///@}

  ///@{
  /**
   * Whether the output has quads only: lines are traced twice as far apart, and every face between
   * them is cut into quads by its centre and the middles of its edges. Four edges meet in more of the
   * vertices; at the same number of points the surface is met less closely. Default: off.
   */
  vtkSetMacro(PureQuads, bool);
  vtkGetMacro(PureQuads, bool);
  vtkBooleanMacro(PureQuads, bool);
  ///@}

  ///@{
  /**
   * Whether the output is symmetric about a plane, the one through SymmetryOrigin across SymmetryNormal.
   * What lies on the positive side, to which the normal points, is remeshed and mirrored, whatever lies
   * on the other: a warning counts points of the input without a mirror image. Attributes are mirrored
   * with the points; ports 1 to 3 show the positive side. Default: off.
   */
  vtkSetMacro(Symmetry, bool);
  vtkGetMacro(Symmetry, bool);
  vtkBooleanMacro(Symmetry, bool);
  ///@}

  ///@{
  /**
   * A point of the plane of symmetry, within a million diagonals of the surface, and the direction across it,
   * of any length but 0. Default: (0, 0, 0) and (1, 0, 0).
   */
  vtkSetVector3Macro(SymmetryOrigin, double);
  vtkGetVector3Macro(SymmetryOrigin, double);
  vtkSetVector3Macro(SymmetryNormal, double);
  vtkGetVector3Macro(SymmetryNormal, double);
  ///@}

  ///@{
  /**
   * Faces with more corners than this are split. Range [4, 64], default 5 (paper, section 5.2).
   */
  vtkSetClampMacro(LargestValence, int, 4, 64);
  vtkGetMacro(LargestValence, int);
  ///@}

  ///@{
  /**
   * Whether concave faces are split. Default: on (paper, section 5.2).
   */
  vtkSetMacro(ConvexPartition, bool);
  vtkGetMacro(ConvexPartition, bool);
  vtkBooleanMacro(ConvexPartition, bool);
  ///@}

  ///@{
  /**
   * Whether the output keeps every handle, hole and component of the input; when off, those
   * smaller than the spacing of the lines may vanish. Default: on.
   */
  vtkSetMacro(PreserveTopology, bool);
  vtkGetMacro(PreserveTopology, bool);
  vtkBooleanMacro(PreserveTopology, bool);
  ///@}

  ///@{
  /**
   * Breaks ties between places of equal rank where lines may begin. The result is the same for the
   * same seed. Range [0, 2147483647], default 0.
   */
  vtkSetClampMacro(Seed, int, 0, 2147483647);
  vtkGetMacro(Seed, int);
  ///@}

  ///@{
  /**
   * Number of threads; 0 stands for all of the machine. The result does not depend on it. Range
   * [0, 1024], default 0.
   */
  vtkSetClampMacro(NumberOfThreads, int, 0, 1024);
  vtkGetMacro(NumberOfThreads, int);
  ///@}

  ///@{
  /**
   * Whether ports 1, 2 and 3 are filled. Each costs memory and a little time on large inputs; an
   * output that is switched off is empty. Default: on.
   */
  vtkSetMacro(GenerateDirections, bool);
  vtkGetMacro(GenerateDirections, bool);
  vtkBooleanMacro(GenerateDirections, bool);
  vtkSetMacro(GenerateConfidence, bool);
  vtkGetMacro(GenerateConfidence, bool);
  vtkBooleanMacro(GenerateConfidence, bool);
  vtkSetMacro(GenerateLines, bool);
  vtkGetMacro(GenerateLines, bool);
  vtkBooleanMacro(GenerateLines, bool);
  ///@}

  /**
   * What the last execution found and did, as a JSON object: `counts` (repairs of the input, lines,
   * output elements, distances of creases and borders from the output's edges), `warnings` (sentences), and `stages`,
   * each with its seconds, its peak of memory in bytes and whether the cached result served.
   */
  std::string GetReport() const;

protected:
  /// @cond what subclasses see; documented by the functions above
  vtkAnisotropicQuadRemesher();
  ~vtkAnisotropicQuadRemesher() override;

  int FillOutputPortInformation(int port, vtkInformation* info) override;
  int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  int DensityMode = TOLERANCE;
  double Tolerance = 0.0005;
  vtkIdType TargetNumberOfPoints = 5000;
  bool UseDensityArray = false;
  double CurvatureRadius = 0.01;
  int SmoothingIterations = 5;
  double ConfidenceAngle = 30.0;
  bool FeatureLines = true;
  double FeatureAngle = 40.0;
  bool BoundaryLines = true;
  bool LockLines = false;
  bool UseLockArray = false;
  double LargestSpacing = 0.05;
  double Anisotropy = 1.0;
  double Adaptivity = 1.0;
  bool PureQuads = false;
  bool Symmetry = false;
  double SymmetryOrigin[3] = { 0.0, 0.0, 0.0 };
  double SymmetryNormal[3] = { 1.0, 0.0, 0.0 };
  int LargestValence = 5;
  bool ConvexPartition = true;
  bool PreserveTopology = true;
  int Seed = 0;
  int NumberOfThreads = 0;
  bool GenerateDirections = true;
  bool GenerateConfidence = true;
  bool GenerateLines = true;
  /// @endcond

private:
  vtkAnisotropicQuadRemesher(const vtkAnisotropicQuadRemesher&) = delete;
  void operator=(const vtkAnisotropicQuadRemesher&) = delete;

  bool ReadDensityArray(vtkInformationVector** inputVector, vtkPolyData* input);
  bool ReadLockedLines(vtkInformationVector** inputVector, vtkPolyData* input);
  int RunKernels(vtkPolyData* input);
  void FillRemeshed(vtkPolyData* input, vtkPolyData* output);
  void FillField(vtkPolyData* input, vtkPolyData* directions, vtkPolyData* confidence);
  void FillLines(vtkPolyData* input, vtkPolyData* output);

  class vtkInternals;
  std::unique_ptr<vtkInternals> Internals;
};

#endif
