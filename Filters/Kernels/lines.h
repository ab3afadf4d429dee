/* SPDX-License-Identifier: BSD-3-Clause */
/* Lines on the surface, and the lists of their chords per face (paper 3.2).
 *
 * A curvature line is a sequence of samples, each the crossing of one edge of the surface; between
 * two samples it is one straight chord inside one face. Whether two chords of a face cross is then
 * decided by the cyclic order of their ends along its border, and by nothing else. A chain
 * (boundary or feature line) runs along edges: its samples are the starts of its half-edges. */
#ifndef AQR_LINES_H
#define AQR_LINES_H

#include "surface.h"

typedef struct aqr_sample
{
  vec3 p;
  aqr_index line; /* set by aqr_lines_add, as are next and key */
  aqr_index next; /* the sample whose chord is the next in the list of `face`, or AQR_NONE */
  double t;       /* position along `edge`, inside (0, 1); 0 on chains */
  aqr_index edge; /* the edge crossed: the smaller of its two half-edges; on chains the half-edge itself */
  aqr_index face; /* of the chord from this sample to the next; of the previous chord for the last sample */
  aqr_index key;  /* breaks ties of t along an edge */
  float arc;      /* length since the first sample */
  float sigma;    /* spacings of crossing lines passed since the first sample */
  uint8_t isotropic;
} aqr_sample;

typedef struct aqr_line
{
  size_t first, count; /* into aqr_lines.samples; a closed line repeats its first crossing as its last sample */
  uint8_t type;        /* aqr_line_type */
  uint8_t ends[2];     /* aqr_line_end */
  bool closed;
  bool is_chain;
  aqr_index partner[2]; /* sample on the other side of the seam that the end continues, or AQR_NONE */
} aqr_line;

static inline bool aqr_ends_on_chain(const aqr_line* line, unsigned end)
{
  return line->ends[end] == AQR_END_BOUNDARY || line->ends[end] == AQR_END_FEATURE;
}

typedef struct aqr_lines
{
  aqr_line* lines;
  size_t n_lines, line_capacity;
  aqr_sample* samples;
  size_t n_samples, sample_capacity;
  aqr_index* across; /* per sample of a chain: as its `next`, in the list of the face on the other side */
  size_t across_capacity;
  aqr_index* head; /* per face: the sample that its newest chord starts at, or AQR_NONE */
  size_t n_faces;
} aqr_lines;

aqr_status aqr_lines_init(aqr_context* c, const aqr_surface* s, aqr_lines* l);
void aqr_lines_free(aqr_context* c, aqr_lines* l);

/* Appends a line with copies of its samples and enters its chords into the faces' lists. Chains come first. */
aqr_status aqr_lines_add(
  aqr_context* c, aqr_lines* l, const aqr_surface* s, const aqr_line* line, const aqr_sample* samples);

/* The chord that comes after that of sample n in the list of face f. */
static inline aqr_index aqr_next_chord(const aqr_lines* l, aqr_index n, aqr_index f)
{
  return l->samples[n].face == f ? l->samples[n].next : l->across[n];
}

/* The half-edge of face f that lies on the sample's edge. */
static inline aqr_index aqr_sample_half_edge(const aqr_surface* s, const aqr_sample* a, aqr_index f)
{
  return aqr_face_of(a->edge) == f ? a->edge : aqr_any_twin(s, a->edge);
}

/* The sample of a chain that starts on the edge of `at`; AQR_NONE where no chain runs along it. */
aqr_index aqr_chain_at(const aqr_surface* s, const aqr_lines* l, const aqr_sample* at);

static inline vec3 aqr_edge_point(const aqr_surface* s, aqr_index h, double t)
{
  vec3 a = aqr_point(s, aqr_from(s, h)), b = aqr_point(s, aqr_to(s, h));
  return v3_madd(a, t, v3_sub(b, a));
}

/* Position of a chord's end along the border of face f, counter-clockwise; no two ends in a face
 * are equal. */
bool aqr_border_before(const aqr_surface* s, aqr_index f, const aqr_sample* a, const aqr_sample* b);

/* Whether the chords a0-a1 and b0-b1 of face f cross, by the cyclic order of their ends: 0 no, 1
 * when b runs from the right of a to its left, -1 the other way. */
int aqr_chords_cross(const aqr_surface* s, aqr_index f, const aqr_sample* a0, const aqr_sample* a1,
  const aqr_sample* b0, const aqr_sample* b1);

/* The name of an edge: the smaller of its half-edges. */
static inline aqr_index aqr_edge_of(const aqr_surface* s, aqr_index h)
{
  aqr_index t = aqr_any_twin(s, h);
  return t < h ? t : h;
}

#endif
