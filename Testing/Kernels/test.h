/* SPDX-License-Identifier: BSD-3-Clause */
/* A test program is a list of AQR_TEST(name) functions and AQR_TEST_MAIN at its end. Run with a
 * name it runs that test, without one all of them. CMake reads the names from the source, so each
 * is a ctest of its own. */
#ifndef AQR_TEST_H
#define AQR_TEST_H

#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct aqr_test
{
  const char* name;
  void (*run)(void);
  struct aqr_test* next;
} aqr_test;

static aqr_test* aqr_tests;
static int aqr_failures;

/* Blocks of memory held. The linker sends the allocations of the test and of all it is linked with here, the kernels'
 * own allocator among them; elsewhere than with such a linker nothing is counted. */
static atomic_long aqr_blocks;

#ifdef AQR_COUNT_BLOCKS
/* NOLINTBEGIN(bugprone-reserved-identifier): the linker makes these names */
void* __real_malloc(size_t bytes);
void* __real_calloc(size_t n, size_t bytes);
void* __real_realloc(void* old, size_t bytes);
void __real_free(void* p);
void* __wrap_malloc(size_t bytes);
void* __wrap_calloc(size_t n, size_t bytes);
void* __wrap_realloc(void* old, size_t bytes);
void __wrap_free(void* p);

void* __wrap_malloc(size_t bytes)
{
  void* p = __real_malloc(bytes);
  aqr_blocks += p != NULL;
  return p;
}
void* __wrap_calloc(size_t n, size_t bytes)
{
  void* p = __real_calloc(n, bytes);
  aqr_blocks += p != NULL;
  return p;
}
void* __wrap_realloc(void* old, size_t bytes)
{
  void* p = __real_realloc(old, bytes);
  aqr_blocks += !old && p;
  aqr_blocks -= old && !p && !bytes;
  return p;
}
void __wrap_free(void* p)
{
  aqr_blocks -= p != NULL;
  __real_free(p);
}
/* NOLINTEND(bugprone-reserved-identifier) */
#endif

#define AQR_TEST(test_name)                                                                                            \
  static void test_name(void);                                                                                         \
  static aqr_test entry_##test_name = { #test_name, test_name, NULL };                                                 \
  __attribute__((constructor)) static void register_##test_name(void)                                                  \
  {                                                                                                                    \
    entry_##test_name.next = aqr_tests;                                                                                \
    aqr_tests = &entry_##test_name;                                                                                    \
  }                                                                                                                    \
  static void test_name(void)

#define CHECK(condition)                                                                                               \
  do                                                                                                                   \
  {                                                                                                                    \
    if (!(condition))                                                                                                  \
    {                                                                                                                  \
      printf("%s:%d: failed: %s\n", __FILE__, __LINE__, #condition);                                                   \
      aqr_failures++;                                                                                                  \
    }                                                                                                                  \
  } while (0)

/* Also prints the measured value. */
#define CHECK_BELOW(value, bound)                                                                                      \
  do                                                                                                                   \
  {                                                                                                                    \
    double measured_ = (value), bound_ = (bound);                                                                      \
    printf("%s = %g (bound %g)\n", #value, measured_, bound_);                                                         \
    if (!(measured_ < bound_))                                                                                         \
    {                                                                                                                  \
      printf("%s:%d: failed: %s < %s\n", __FILE__, __LINE__, #value, #bound);                                          \
      aqr_failures++;                                                                                                  \
    }                                                                                                                  \
  } while (0)

#define AQR_TEST_MAIN                                                                                                  \
  int main(int argc, char** argv)                                                                                      \
  {                                                                                                                    \
    int found = 0;                                                                                                     \
    for (aqr_test* t = aqr_tests; t; t = t->next)                                                                      \
      if (argc < 2 || strcmp(argv[1], t->name) == 0)                                                                   \
      {                                                                                                                \
        found++;                                                                                                       \
        long held = aqr_blocks;                                                                                        \
        t->run();                                                                                                      \
        if (aqr_blocks != held)                                                                                        \
        {                                                                                                              \
          printf("%s: failed: %ld blocks of memory were left behind\n", t->name, aqr_blocks - held);                   \
          aqr_failures++;                                                                                              \
        }                                                                                                              \
      }                                                                                                                \
    if (!found)                                                                                                        \
      printf("no test named %s\n", argc > 1 ? argv[1] : "at all");                                                     \
    return found && !aqr_failures ? 0 : 1;                                                                             \
  }

#endif
