/* SPDX-License-Identifier: BSD-3-Clause */
/* Loaded before libc into the program under test: a socket that could leave the machine ends it. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>

int socket(int domain, int type, int protocol)
{
  if (domain != AF_UNIX)
  {
    fputs("a network socket was asked for\n", stderr);
    abort();
  }
  int (*real)(int, int, int);
  *(void**)&real = dlsym(RTLD_NEXT, "socket");
  return real(domain, type, protocol);
}
