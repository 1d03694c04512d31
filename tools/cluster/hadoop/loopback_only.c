// Preloaded into Hadoop's daemons and application masters (cluster.sh): whoever asks to listen on all of the machine's
// addresses gets the loopback address, 127.0.0.1.

#define _GNU_SOURCE
#include <arpa/inet.h>
#include <dlfcn.h>
#include <netinet/in.h>
#include <string.h>
#include <sys/socket.h>

int bind(int fd, const struct sockaddr* address, socklen_t size) {
  int (*real)(int, const struct sockaddr*, socklen_t);
  *(void**)&real = dlsym(RTLD_NEXT, "bind");
  if (address != NULL && address->sa_family == AF_INET && size >= sizeof(struct sockaddr_in)) {
    struct sockaddr_in changed;
    memcpy(&changed, address, sizeof changed);
    if (changed.sin_addr.s_addr == htonl(INADDR_ANY)) {
      changed.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
      return real(fd, (const struct sockaddr*)&changed, sizeof changed);
    }
  }
  return real(fd, address, size);
}
