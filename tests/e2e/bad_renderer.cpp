// A renderer that does wrong in its 1000th update, as its options say.
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <unistd.h>

#include "host/renderer/forceshade_renderer.h"

namespace {

struct Bad {
    std::string what;
    int update = 0;
};

} // namespace

int fsr_version() {
#ifdef BAD_VERSION
    return FSR_VERSION + 1;
#else
    return FSR_VERSION;
#endif
}

int fsr_open(const fsr_scene* scene, void** renderer) {
    *renderer = new Bad{scene->options};
    if (std::strcmp(scene->options, "refuse") == 0)
        return 7;
    if (std::strcmp(scene->options, "crash in open") == 0)
        std::abort();
    return 0;
}

int fsr_reset(void*) {
    return 0;
}

int fsr_update(void* renderer, const double probe[3], fsr_touch* touch) {
    auto& self = *static_cast<Bad*>(renderer);
    touch->force[2] = 1;
    if (self.what == "y")
        touch->force[0] = 1e3 * probe[1];
    if (++self.update < 1000)
        return 0;
    if (self.what == "crash")
        *reinterpret_cast<volatile int*>(8) = 1;
    if (self.what == "exit")
        ::_exit(3);
    if (self.what == "sleep")
        ::usleep(60000000);
    if (self.what == "beyond")
        std::memset(static_cast<void*>(touch), 0, sizeof *touch + 40);
    if (self.what == "fail")
        return 4;
    if (self.what == "throw")
        throw std::runtime_error("out of ideas");
    if (self.what == "latin")
        return 5;
    if (self.what == "nan")
        touch->force[1] = NAN;
    if (self.what == "huge")
        touch->force[0] = 1e9;
    return 0;
}

#ifndef BAD_SYMBOLS
const char* fsr_error(void*, int error) {
    return error == 7 ? "this scene has no mesh that I like" : error == 5 ? "zu gro\xDF" : "";
}
#endif

void fsr_close(void* renderer) {
    if (static_cast<Bad*>(renderer)->what == "crash in close")
        std::abort();
    delete static_cast<Bad*>(renderer);
}
