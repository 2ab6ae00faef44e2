// The precision a kernel is compiled for. Constants are written real(0.5LF): rounded once, by the compiler.
#ifdef FS_F64
#define real double
#define real2 dvec2
#define real3 dvec3
#define real4 dvec4
#define SMALLEST_NORMAL 2.2250738585072014e-308LF
#define LARGEST 1.7976931348623157e308LF
#define EPSILON 2.220446049250313e-16LF
#else
#define real float
#define real2 vec2
#define real3 vec3
#define real4 vec4
#define SMALLEST_NORMAL 1.1754943508222875e-38
#define LARGEST 3.4028234663852886e38
#define EPSILON 1.1920928955078125e-07
#endif
#define ZERO real(0.0LF)
#define ONE real(1.0LF)
