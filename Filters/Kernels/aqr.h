/* SPDX-License-Identifier: BSD-3-Clause */
/**
 * @file aqr.h
 * Anisotropic quad-dominant remeshing of triangle surfaces: the manual of the C library.
 *
 * The method is that of Marinov and Kobbelt, "Direct Anisotropic Quad-Dominant Remeshing" (2004),
 * called "the paper" in every comment.  A surface goes in as points and triangles; a mesh of mostly
 * quads comes out whose edges follow the lines of principal curvature.
 *
 *     aqr_remesher* r = NULL;
 *     aqr_options options = aqr_default_options();
 *     options.density = AQR_DENSITY_POINTS;
 *     options.target_points = 5000;
 *     aqr_status status = aqr_remesher_new(NULL, &r);
 *     if (!status) status = aqr_remesher_set_input(r, &input);
 *     if (!status) status = aqr_remesher_run(r, &options);
 *     if (!status) use(aqr_remesher_mesh(r));
 *     aqr_remesher_free(r);
 *
 * Rules that hold for every function:
 * - nothing is printed, nothing exits, no global is kept; two remeshers are independent of each
 * other;
 * - every array in a result belongs to the remesher and lives until the next run, set_input or
 * free;
 * - the same input and options give the same bytes, whatever `parallel_for` does;
 * - after a failure the remesher holds no result and may be used again.
 */
#ifndef AQR_H
#define AQR_H

#include <stddef.h>
#include <stdint.h>

/** @def AQR_API
 * Makes a function visible outside of the library. */
#if defined(AQR_SHARED) && defined(_WIN32)
#ifdef AQR_BUILD
#define AQR_API __declspec(dllexport)
#else
#define AQR_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define AQR_API __attribute__((visibility("default")))
#else
#define AQR_API
#endif

#ifdef __cplusplus
extern "C"
{
#endif

  /** Index of a point, face or half-edge. The largest value means "none". */
  typedef uint32_t aqr_index;
/** The index that means "none". */
#define AQR_NONE UINT32_MAX

  /** Why a call failed. */
  typedef enum aqr_status
  {
    AQR_OK = 0,
    AQR_CANCELLED,          /**< the progress callback returned false */
    AQR_OUT_OF_MEMORY,      /**< the allocator hook returned NULL */
    AQR_EMPTY_INPUT,        /**< no point or no triangle */
    AQR_NON_FINITE_POINT,   /**< a coordinate used by a triangle is NaN or infinite */
    AQR_INDEX_OUT_OF_RANGE, /**< a triangle or a locked edge names a point that does not exist */
    AQR_DEGENERATE_INPUT,   /**< no triangle of positive area: all points coincident or collinear */
    AQR_TOO_LARGE,          /**< more points, triangles, or samples of lines than the index type can hold */
    AQR_BAD_OPTION,         /**< an option is NaN or outside its range; see aqr_remesher_message() */
    AQR_NO_INPUT,           /**< run before set_input */
    AQR_INTERNAL            /**< an invariant of the library did not hold: a defect, please report it */
  } aqr_status;

  /** One English sentence without a newline; never NULL. */
  AQR_API const char* aqr_status_string(aqr_status status);

  /** What the library borrows from its caller. Zero-initialised hooks mean: malloc, one thread, no
   * progress. */
  typedef struct aqr_hooks
  {
    void* user; /**< handed to every hook */
    /** malloc (old NULL), realloc, and free (bytes 0): as C's realloc, with the old size told. */
    void* (*reallocate)(void* user, void* old, size_t old_bytes, size_t bytes);
    /** Called on the thread that called run, at least every tenth of a second on ordinary hardware.
     * `fraction` never decreases in one run; `stage` is a static string. Return 0 to cancel. */
    int (*progress)(void* user, double fraction, const char* stage);
    /** Call body(data, begin, end) over disjoint ranges that cover [0, count), on any threads, in
     * any order. */
    void (*parallel_for)(
      void* user, size_t count, size_t grain, void (*body)(void* data, size_t begin, size_t end), void* data);
  } aqr_hooks;

  /** The input surface, read during set_input only. */
  typedef struct aqr_input
  {
    size_t number_of_points;    /**< length of the arrays per point */
    const float* points_f;      /**< 3 * number_of_points, or NULL */
    const double* points_d;     /**< 3 * number_of_points, used when points_f is NULL */
    size_t number_of_triangles; /**< length of the arrays per triangle */
    const int64_t* triangles;   /**< 3 * number_of_triangles point indices */
    size_t number_of_locked;    /**< pairs in `locked` */
    const int64_t* locked;      /**< 2 * number_of_locked point indices, or NULL: edges that become lines as creases do.
                                   A point is told by where it is, so that it need be no corner of a triangle */
  } aqr_input;

  /** What asks for the density of the output. */
  typedef enum aqr_density
  {
    AQR_DENSITY_TOLERANCE = 0, /**< lines spaced so that a chord departs from the surface by `tolerance` */
    AQR_DENSITY_POINTS = 1     /**< the tolerance that gives `target_points` */
  } aqr_density;

  /** All parameters. Lengths are fractions of the diagonal of the input's bounding box, angles are
   * degrees. */
  typedef struct aqr_options
  {
    uint32_t cookie;             /**< set by aqr_default_options() */
    aqr_density density;         /**< AQR_DENSITY_TOLERANCE */
    double tolerance;            /**< [1e-7, 0.1], 0.0005 */
    int64_t target_points;       /**< [4, 2^31), 5000; met within 5 % where the input can carry it */
    const double* density_scale; /**< NULL, or one factor per input point, > 0: points per area are multiplied by it,
                                    by no more than 1e6 and no less than 1e-6; where target_points are asked
                                    for, only what one place has against another counts */
    double curvature_radius;   /**< [0, 0.2], 0.01: averaging ball of the curvature tensors (paper 2), where points are
                                  to lie 1/120 and more apart; half where less, a quarter where less than 1/240. A
                                  tolerance stands for 1.7 / tolerance points. Never less than about two edges */
    int smoothing_iterations;  /**< [0, 1000], 5: confidence-weighted smoothing of the tensors
                                  (paper 4.1) */
    double confidence_angle;   /**< [0, 90], 30: directions inside a face that differ by more are not
                                  trusted (4.1) */
    int feature_lines;         /**< 0 or 1, 1: creases become lines (paper 3), those that bend the surface least
                                  only where target_points can pay for them */
    double feature_angle;      /**< (0, 180], 40: dihedral deviation from flat that makes an edge a crease */
    int boundary_lines;        /**< 0 or 1, 1: boundary loops become lines; 0 lets the border be cut
                                  coarsely */
    double largest_spacing;    /**< [1e-4, 1], 0.05: no two neighbouring lines are meant to be farther
                                  apart (3.2); with a target, not held to below 2.2 times the spacing
                                  that would spread the points evenly. Neither it nor another option brings them nearer
                                  than a quarter of the root of the area that a point of the cleaned input has */
    double anisotropy;         /**< [0, 1], 1: how far faces are stretched where curvatures differ; 0: squares,
                                  as fine as the larger curvature asks for */
    double adaptivity;         /**< [0, 1], 1: how far density follows curvature; 0: everywhere as for the mean */
    int pure_quads;            /**< 0 or 1, 0. 1: lines twice as far apart, then every face cut into quads by its
                                  centre and the middles of its edges */
    int symmetry;              /**< 0 or 1, 0. 1: the mesh is symmetric about a plane. What lies on the plane's positive
                                  side is remeshed and mirrored, whatever lies on the other; the field and the
                                  lines are those of that side */
    double symmetry_origin[3]; /**< 0 0 0: a point of the plane, in the input's coordinates, within a million diagonals
                                  of the surface */
    double symmetry_normal[3]; /**< 1 0 0: points to the positive side; any finite length above 0 */
    int largest_valence;       /**< [4, 64], 5: faces with more corners are split (paper 5.2) */
    int convex_partition;      /**< 0 or 1, 1: concave faces are split (paper 5.2) */
    int preserve_topology;     /**< 0 or 1, 1: regions that are not disks are cut; 0: small handles may
                                  vanish */
    uint32_t seed;             /**< 0: breaks ties between seeds of equal rank */
    int show_field;            /**< 0 or 1, 1: aqr_remesher_field() has something to show, which takes memory */
    int show_lines;            /**< 0 or 1, 1: aqr_remesher_lines() likewise */
  } aqr_options;

  /** Every option at its default, with the cookie that aqr_remesher_run() asks for. */
  AQR_API aqr_options aqr_default_options(void);

  /** Kind of a line, and of the edge of the mesh that lies on it. */
  typedef enum aqr_line_type
  {
    AQR_LINE_MIN = 0,
    AQR_LINE_MAX = 1,
    AQR_LINE_BOUNDARY = 2,
    AQR_LINE_FEATURE = 3
  } aqr_line_type;

  /** Why a line stopped at one of its ends. */
  typedef enum aqr_line_end
  {
    AQR_END_LOOP = 0,      /**< closed on itself */
    AQR_END_BOUNDARY = 1,  /**< reached the boundary of the surface */
    AQR_END_FEATURE = 2,   /**< reached a feature line */
    AQR_END_PROXIMITY = 3, /**< another line of its family was nearer than the stop distance */
    AQR_END_SELF = 4,      /**< its own tail was nearer than the stop distance */
    AQR_END_LENGTH = 5,    /**< the cap on its length */
    AQR_END_CORNER = 6,    /**< a node of the feature graph */
    AQR_END_CUT = 7        /**< drawn only to keep the topology */
  } aqr_line_end;

  /** Where an output point came from: barycentric weights over three input points. */
  typedef struct aqr_origin
  {
    aqr_index point[3]; /**< indices into the input's points; equal for an input point itself */
    float weight[3];    /**< >= 0, sum 1 */
    aqr_index triangle; /**< index of the input triangle it lies on */
  } aqr_origin;

  /** Port 0: the quad-dominant mesh. Closed where the input is; consistently oriented. */
  typedef struct aqr_mesh
  {
    size_t number_of_points;      /**< length of the arrays per point */
    const double* points;         /**< 3 per point, in the input's coordinates */
    const double* normals;        /**< 3 per point, unit, of the original surface */
    const aqr_origin* origins;    /**< per point */
    const uint8_t* point_kind;    /**< per point: 0 interior, 1 boundary, 2 feature, 3 corner */
    size_t number_of_faces;       /**< length of the arrays per face */
    const int64_t* offsets;       /**< number_of_faces + 1 */
    const int64_t* connectivity;  /**< offsets[number_of_faces] point indices, counter-clockwise */
    const aqr_index* face_source; /**< per face: an input triangle below it */
    size_t number_of_corners;     /**< offsets[number_of_faces] */
  } aqr_mesh;

  /** Ports 1 and 2: the cleaned surface with its direction field. */
  typedef struct aqr_field_view
  {
    size_t number_of_points;          /**< length of the arrays per point */
    const double* points;             /**< 3 per point, in the input's coordinates */
    const aqr_origin* origins;        /**< per point */
    const double* normals;            /**< 3 per point, unit */
    const double* min_direction;      /**< 3 per point, unit, tangent */
    const double* max_direction;      /**< 3 per point, unit, tangent */
    const double* min_curvature;      /**< per point, <= max_curvature, one over the input's unit of length */
    const double* max_curvature;      /**< per point, positive where the surface bends away from its normal */
    const float* point_confidence;    /**< per point, [0,1] (paper 4.1) */
    size_t number_of_triangles;       /**< length of the arrays per triangle */
    const aqr_index* triangles;       /**< 3 per triangle */
    const aqr_index* triangle_source; /**< per triangle: the input triangle it came from */
    const float* triangle_confidence; /**< per triangle, [0,1] (paper, equation 1) */
    uint64_t revision;                /**< another number when the field was computed anew, the same when reused */
  } aqr_field_view;

  /** Port 3: polylines on the cleaned surface. A closed line repeats its first point at its end. */
  typedef struct aqr_lines_view
  {
    size_t number_of_lines;    /**< length of the arrays per line */
    const int64_t* offsets;    /**< number_of_lines + 1, into the arrays per point */
    const uint8_t* type;       /**< per line, aqr_line_type of its seed */
    const uint8_t* ends;       /**< 2 per line, aqr_line_end of the first and the last point */
    size_t number_of_points;   /**< length of the arrays per point */
    const double* points;      /**< 3 per point, in the input's coordinates */
    const double* curvature;   /**< per point: normal curvature across the line */
    const double* arc_length;  /**< per point, from the line's first point */
    const aqr_index* triangle; /**< per point: triangle of aqr_field_view it lies on */
    const uint8_t* isotropic;  /**< per point: 1 in a stretch that ignores the tensor field (paper 4.2) */
  } aqr_lines_view;

  /** What was repaired in the input, and what the run did. All counts. */
  typedef struct aqr_report
  {
    size_t degenerate_triangles; /**< dropped */
    size_t duplicate_triangles;  /**< dropped */
    size_t merged_points;        /**< exactly coincident points joined */
    size_t unused_points;        /**< not used by any triangle, passed over */
    size_t split_edges;          /**< non-manifold edges cut apart */
    size_t split_points;         /**< non-manifold points cut apart */
    size_t flipped_triangles;    /**< turned to agree with their neighbours */
    size_t unorientable_edges;   /**< cut because no orientation agrees across them */
    size_t refined_points;       /**< added to halve edges longer than what lines need (paper 3.2) */
    size_t feature_edges;        /**< edges that are creases, once long ones are halved */
    size_t given_up_edges;       /**< creases that no line follows, since target_points cannot pay for all: those that
                                    bend the surface least; with symmetry, of the half that is kept */
    size_t locked_edges;         /**< edges of the cleaned input that `locked` of the input asks for */
    size_t locked_missed;        /**< pairs of `locked` that are no edge of the cleaned input, passed over */
    size_t boundary_loops;       /**< of the cleaned input */
    size_t components;           /**< of the cleaned input */
    size_t lines;                /**< traced */
    size_t line_samples;         /**< edge crossings of all lines */
    size_t proximity_queries;    /**< questions for the nearest other line */
    size_t faces_crossed;        /**< by all growing lines, those not kept too: the work of tracing */
    size_t bounded_points;       /**< of the cleaned input, where largest_spacing asks for lines nearer than the input
                                    can carry and is not met; 0 where target_points are asked for */
    size_t topology_cuts;        /**< lines added so that every region is a disk */
    size_t coarsened_components; /**< components that carried no lines and were decimated instead */
    size_t topology_lost;        /**< 1 when preserve_topology was asked for and no attempt kept the Euler number */
    size_t asymmetric_points;    /**< of the cleaned input, with no other point at their mirror image; with symmetry */
    size_t target_missed;        /**< 1 when target_points could not be met within 5 % */
    double tolerance;            /**< used, as a fraction of the diagonal */
    double feature_rms;          /**< distance of creases that are kept from the output's edges: root mean square */
    double feature_max;          /**< ... and largest, as fractions of the diagonal; 0 where there are none */
    double boundary_rms;         /**< the same of the boundary */
    double boundary_max;         /**< the same of the boundary */
  } aqr_report;

  /** Seconds and memory of one stage of the last run. */
  typedef struct aqr_stage
  {
    const char* name;  /**< static string */
    double seconds;    /**< 0 when the cached result served */
    size_t peak_bytes; /**< largest total held by the library during the stage */
    size_t end_bytes;  /**< held when the stage ended */
    int reused;        /**< 1 when the cached result served */
  } aqr_stage;

  /** One surface, the stages computed for it, and the last result. */
  typedef struct aqr_remesher aqr_remesher;

  /** hooks may be NULL. *remesher is NULL after a failure. */
  AQR_API aqr_status aqr_remesher_new(const aqr_hooks* hooks, aqr_remesher** remesher);
  /** Frees the remesher and all it holds; NULL is allowed. */
  AQR_API void aqr_remesher_free(aqr_remesher* remesher);

  /** Copies what it needs; the arrays may go afterwards. Drops every cached stage. */
  AQR_API aqr_status aqr_remesher_set_input(aqr_remesher* remesher, const aqr_input* input);

  /** Replaces the hooks but for the allocator, which stays. With an allocator `user` stays too, since it is handed to
   * every hook: what the new hooks are to see has to be reached from it. */
  AQR_API void aqr_remesher_set_hooks(aqr_remesher* remesher, const aqr_hooks* hooks);

  /** Runs the stages whose parameters changed since the last run, and all that follow them. */
  AQR_API aqr_status aqr_remesher_run(aqr_remesher* remesher, const aqr_options* options);

  /** The mesh of the last run, if that returned AQR_OK; NULL otherwise. */
  AQR_API const aqr_mesh* aqr_remesher_mesh(const aqr_remesher* remesher);
  /** The directions of that run, likewise; NULL where show_field was 0. */
  AQR_API const aqr_field_view* aqr_remesher_field(const aqr_remesher* remesher);
  /** The lines of that run, likewise; NULL where show_lines was 0. */
  AQR_API const aqr_lines_view* aqr_remesher_lines(const aqr_remesher* remesher);

  /** Counts of the last call; never NULL, partly filled after a failure. */
  AQR_API const aqr_report* aqr_remesher_report(const aqr_remesher* remesher);
  /** All stages in their order, `*count` of them. */
  AQR_API const aqr_stage* aqr_remesher_stages(const aqr_remesher* remesher, size_t* count);

  /** More about the last failure than its status says (which option, which point); "" otherwise. */
  AQR_API const char* aqr_remesher_message(const aqr_remesher* remesher);

#ifdef __cplusplus
}
#endif

#endif
