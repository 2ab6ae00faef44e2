// Every figure with the processor that it was taken on.
#include <benchmark/benchmark.h>

#include "host/sweep/sweep.h"

int main(int argc, char** argv) {
    benchmark::AddCustomContext("processor", forceshade::cpu_name());
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv))
        return 2;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
