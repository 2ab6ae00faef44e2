// Files for ParaView: XML but for their numbers, and written as they are computed.
#include "tests/e2e/path_workplace.h"

namespace forceshade::testing {
namespace {

class Vtp : public Paths {
protected:
    void expect_xml(const std::string& name) const {
        const char* const parse = "import sys, xml.etree.ElementTree\n"
                                  "data = open(sys.argv[1], 'rb').read()\n"
                                  "head = data[:data.index(b'<AppendedData')]\n"
                                  "xml.etree.ElementTree.fromstring(head + b'</VTKFile>')\n";
        const Outcome outcome =
            run({.arguments = {"-c", parse, name}, .folder = folder_.path(), .program = "/usr/bin/python3"});
        EXPECT_EQ(outcome.code, 0) << outcome.error;
    }
};

TEST_F(Vtp, OfAFieldIsXml) {
    write("one.toml", kOneCase);
    EXPECT_TRUE(says(expect_success({"field", "one.toml", "--out", "a.exr", "--also", "vti,vtp"}).error,
                     "wrote a.exr, a.vti and a.vtp\n"));
    expect_xml("a.vti");
    expect_xml("a.vtp");
}

// What may be held of the rows of paths is bounded already; lines add their buffers.
TEST_F(Vtp, OfLongPathsTakesNoMemoryForSamples) {
    write("long.toml", scene("count = 5\nsteps = 200000\n")); // a million samples of 64 bytes
    const std::uint64_t plain = expect_success(explore("long.toml", "a.csv")).peak_memory,
                        lines = expect_success(explore("long.toml", "a.csv", {"--also", "vtp"})).peak_memory;
    EXPECT_LT(lines, plain + 32 * kMebibyte) << plain / kMebibyte << " MiB, then " << lines / kMebibyte;
    EXPECT_GT(std::filesystem::file_size(path("a.vtp")), 4 * kMebibyte);
    expect_xml("a.vtp");
}

} // namespace
} // namespace forceshade::testing
