// L6: the answer of a god-object, wherever probes aim: a force where something stands between proxy and probe, none
// where nothing does, no larger than the proxy's place gives, along the normals of the facets named; and on the proxy's
// side.
#include <cstdlib>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/mesh/god_object_run.h"

namespace forceshade {
namespace {

struct AnswerTally {
    std::uint64_t steps = 0, contacts = 0, unfinished = 0;
    std::uint64_t grew = 0, dropped = 0, phantoms = 0, unbalanced = 0, far = 0, crossed = 0;
    double growth = 0, residual = 0, distance = 0; /* 1: the worst, of what is finished */

    std::uint64_t wrong() const { return grew + dropped + phantoms + unbalanced + far + crossed; }
};

/// All in the mesh's frame, in double, from the places that an update began and ended with.
struct Update {
    glm::dvec3 before, proxy, contact, probe; /* the proxy a skin off, before and after; on the surface */
};

template <typename T> class Answers : walks::Run<T> {
public:
    explicit Answers(const walks::Terrain& terrain) : walks::Run<T>(terrain.polygons), name_(terrain.name) {}

    const AnswerTally& run(std::uint64_t walks, std::uint64_t seed) {
        for (std::uint64_t i = 0; i < walks; ++i) {
            walks::Prober prober(this->structure, seed * 1000003 + i);
            this->state = {};
            glm::dvec3 before(0);
            std::vector<glm::dvec3> course;
            for (unsigned step = 0; step < walks::Aimer::kSteps; ++step) {
                course.push_back(step == 0 ? prober.begin() : prober.step(course.back()));
                const glm::vec<3, T> probe(course.back());
                const auto contact = this->update(probe);
                const Update update{before, walks::wide(this->state.proxy), walks::wide(contact.proxy),
                                    walks::wide(probe)};
                before = update.proxy;
                const std::string fault = fault_of(update, contact, step > 0);
                if (fault.empty())
                    continue;
                if (tally_.wrong() <= 3) {
                    fmt::print("{} f{} seed {} walk {} step {}: {}\n", name_, 8 * sizeof(T), seed, i, step, fault);
                    for (const glm::dvec3& at : course)
                        fmt::print("  {{{}, {}, {}}},\n", at.x, at.y, at.z);
                }
                break;
            }
        }
        return tally_;
    }

private:
    using walks::Run<T>::kSkin;
    static constexpr double kEpsilon = std::numeric_limits<T>::epsilon();
    static constexpr double kBeside = (sizeof(T) == 8 ? 128 : 8) * kSkin; /* beside tips of rims walks may stop */
    static constexpr double kRounded =
        1e-8; /* of a residual: what rounding makes of where nearly parallel planes meet */

    std::string fault_of(const Update& update, const reference::GodObjectContact<T>& contact, bool follows) {
        ++tally_.steps;
        tally_.contacts += contact.touching;
        tally_.unfinished += !contact.finished;
        const double rounding =
            64 * kEpsilon * (1 + double(reference::largest_coordinate(reference::Vector<double>(update.probe))));
        const double tolerance = 8 * kSkin + rounding, depth = glm::length(update.contact - update.probe);
        const double growth = depth - glm::length((follows ? update.before : update.proxy) - update.probe);
        tally_.growth = std::max(tally_.growth, growth);
        if (this->crossed)
            return note(tally_.crossed, "crosses");
        if (growth > tolerance)
            return note(tally_.grew, fmt::format("grew by {:.3g}", growth));
        const bool blocked = this->grid.touches(update.proxy, update.probe);
        if (contact.touching != blocked && surface_distance(update.probe) > rounding + kBeside &&
            is_certain(update, blocked) && !(contact.touching && holds_at_rim(update, contact)))
            return contact.touching ? note(tally_.phantoms, fmt::format("a phantom, {:.3g}", depth))
                                    : note(tally_.dropped, "free, but not reached");
        return contact.touching && contact.finished ? fault_of_contact(update, contact, tolerance) : "";
    }

    std::string fault_of_contact(const Update& update, const reference::GodObjectContact<T>& contact,
                                 double tolerance) {
        std::vector<glm::dvec3> normals;
        double distance = std::numeric_limits<double>::infinity();
        for (unsigned i = 0; i < contact.count; ++i) {
            normals.push_back(walks::wide(contact.normals[i]));
            const auto point =
                reference::nearest_on_triangle(contact.proxy, reference::triangle_at(this->mesh, contact.triangles[i]));
            distance = std::min(distance, std::sqrt(double(point.square)));
        }
        const glm::dvec3 pull = update.probe - update.contact;
        const double residual = brute::distance_from_cone(pull, normals);
        tally_.residual = std::max(tally_.residual, residual);
        tally_.distance = std::max(tally_.distance, distance);
        if (distance > tolerance)
            return note(tally_.far, fmt::format("{:.3g} from the facets named", distance));
        if (residual > std::max(tolerance, kRounded) + glm::length(pull) / 64)
            return note(tally_.unbalanced, fmt::format("unbalanced by {:.3g}", residual));
        return "";
    }

    /// Whether what stands between proxy and probe does not hang on a few skins, as beside a rim.
    bool is_certain(const Update& update, bool blocked) const {
        if (!blocked)
            return !passes_beside(update.proxy, update.probe);
        for (int i = 0; i < 54; ++i) {
            const double far = (i < 27 ? 2 : 6) * kSkin;
            const glm::dvec3 aside = far * glm::dvec3(i % 3 - 1, i / 3 % 3 - 1, i / 9 % 3 - 1);
            if (this->grid.touches(update.proxy + aside, update.probe + aside) != blocked ||
                this->grid.touches(update.proxy + aside, update.probe) != blocked)
                return false;
        }
        return true;
    }

    /// Whether a line crosses the plane of a triangle within a few skins of it, however narrow its tip is.
    bool passes_beside(const glm::dvec3& from, const glm::dvec3& to) const {
        for (const auto& corners : this->triangles.corners) {
            const glm::dvec3 normal = glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
            const double begin = glm::dot(normal, from - corners[0]), end = glm::dot(normal, to - corners[0]);
            const double time = begin / (begin - end);
            if (!(time >= 0 && time <= 1))
                continue;
            const reference::Triangle<double> triangle{{corners[0], corners[1], corners[2]}, normal};
            if (reference::nearest_on_triangle(from + time * (to - from), triangle).square <= 36 * kSkin * kSkin)
                return true;
        }
        return false;
    }

    /// Whether one facet holds the proxy straight above a probe behind its plane that is no further than a few skins
    /// outside of it: over the rim the proxy, a skin off, is past the surface before the probe is.
    bool holds_at_rim(const Update& update, const reference::GodObjectContact<T>& contact) const {
        for (unsigned i = 0; i < contact.count; ++i) {
            const glm::dvec3 normal = walks::wide(contact.normals[i]);
            const auto triangle = reference::triangle_at(this->mesh, contact.triangles[i]);
            const double depth = glm::dot(normal, walks::wide(triangle.corners[0]) - update.probe);
            const glm::dvec3 foot = update.probe + depth * normal;
            if (depth > 0 && glm::length(foot - update.contact) <= 6 * kSkin &&
                double(reference::nearest_on_triangle(glm::vec<3, T>(foot), triangle).square) <= 36 * kSkin * kSkin)
                return true;
        }
        return false;
    }

    double surface_distance(const glm::dvec3& place) const {
        return std::sqrt(double(reference::nearest(this->mesh, glm::vec<3, T>(place)).square));
    }

    static std::string note(std::uint64_t& count, std::string what) {
        ++count;
        return what;
    }

    std::string name_;
    AnswerTally tally_;
};

std::uint64_t number(const char* variable, std::uint64_t otherwise) {
    const char* text = std::getenv(variable);
    return text ? std::strtoull(text, nullptr, 10) : otherwise;
}

/// Parts thinner than the skin have no room for a proxy: in single precision no more is held of them than that no force
/// is larger than the proxy's place gives.
template <typename T> bool is_thin(const std::string& name) {
    return sizeof(T) == 4 && (name == "wedge 0.001" || name == "flat pole 20");
}

/// FORCESHADE_LONG: 10^9 steps in all. FORCESHADE_MESHES_FROM names the mesh to begin with, so that a long run can go
/// on.
template <typename T> void probe(const std::vector<walks::Terrain>& terrains) {
    const std::uint64_t walks = number("FORCESHADE_WALKS", walks::in_long_form() ? 1500000 : 1000);
    const std::uint64_t seed = number("FORCESHADE_SEED", 1);
    const char* from = std::getenv("FORCESHADE_MESHES_FROM");
    bool begun = from == nullptr;
    for (const walks::Terrain& terrain : terrains) {
        if (!(begun = begun || terrain.name == from))
            continue;
        const unsigned slower = terrain.valence > 100 ? terrain.valence / 8 : 1;
        const AnswerTally tally = Answers<T>(terrain).run(std::max<std::uint64_t>(walks / slower, 5), seed);
        fmt::print("{:20} f{} {:8} steps {:8} contacts: {} grew, {} free, {} phantoms, {} unbalanced, {} far, {} "
                   "crossed, {} unfinished; growth {:.1e}, residual {:.1e}, distance {:.1e}\n",
                   terrain.name, 8 * sizeof(T), tally.steps, tally.contacts, tally.grew, tally.dropped, tally.phantoms,
                   tally.unbalanced, tally.far, tally.crossed, tally.unfinished, tally.growth, tally.residual,
                   tally.distance);
        EXPECT_EQ(tally.grew + tally.crossed, 0u) << terrain.name;
        if (!is_thin<T>(terrain.name)) {
            EXPECT_EQ(tally.wrong(), 0u) << terrain.name;
        }
        EXPECT_LE(tally.unfinished, tally.steps / (is_thin<T>(terrain.name) ? 10 : 50)) << terrain.name;
    }
}

TEST(GodObjectAnswer, SolidsDouble) {
    probe<double>(walks::solids());
    probe<double>(walks::narrow_solids());
}
TEST(GodObjectAnswer, SolidsFloat) {
    probe<float>(walks::solids());
    probe<float>(walks::narrow_solids());
}
TEST(GodObjectAnswer, OpenDouble) {
    probe<double>(walks::open_meshes());
}
TEST(GodObjectAnswer, OpenFloat) {
    probe<float>(walks::open_meshes());
}

struct Answer {
    bool touching;
    double left; /* in skins, from the proxy to the probe */
};

template <typename T> std::vector<Answer> follow(const PolygonSoup& polygons, const std::vector<glm::dvec3>& course) {
    walks::Run<T> run(polygons);
    std::vector<Answer> answers;
    for (const glm::dvec3& at : course) {
        const glm::vec<3, T> probe((at - run.structure.centre) / run.structure.scale);
        const bool touching = run.update(probe).touching;
        answers.push_back({touching, double(glm::length(run.state.proxy - probe) / reference::Skin<T>::kWidth)});
    }
    return answers;
}

/// A wedge thinner than the skin: its planes meet at the far sharp edge, and a probe past the thick end is in front of
/// neither.
TEST(GodObjectAnswer, NoForcePastTheThickEndOfAThinWedge) {
    for (const Answer& answer : follow<float>(walks::narrow_solids()[5].polygons,
                                              {{0.9033547430225982, 1.0863647407898338, 0.05290819690751334},
                                               {0.9999999999999994, 0.9999999999999994, -8.726646259605142e-06},
                                               {1.0000133813354597, 1.0000072313490214, -1.4504776647443512e-05}}))
        EXPECT_FALSE(answer.touching);
}

/// The walk ends above the pole of a fan, stopped by a facet that holds none of its displacement any more.
TEST(GodObjectAnswer, ContactAboveAPoleWhereTheWalkIsStopped) {
    PolygonSoup fan;
    fan.vertices = {{0.5417158885304949, 0.08351012991872439, 0.8364029855964014},
                    {0.5417818969176978, 0.08356751013430458, 0.8363545046343768},
                    {0.5417760954847072, 0.08357571199674704, 0.8363574431578773},
                    {0.541769634411727, 0.08358319532821876, 0.8363608806538648},
                    {0.541755022952845, 0.0835956872131313, 0.8363690968613837},
                    {0.5417470326531442, 0.08360055890286694, 0.8363737855544261},
                    {0.5417387011319184, 0.08360443983372882, 0.836378794169239},
                    {0.5417301196710574, 0.0836072874854263, 0.8363840678303902},
                    {0.5417213822908425, 0.08360907065849146, 0.8363895487585447},
                    {0.5417125847198396, 0.08360976981610706, 0.8363951769035065},
                    {0.5417038233460776, 0.08360937729815594, 0.8364008906021417},
                    {0.5416951941610009, 0.08360789740514692, 0.8364066272539725},
                    {0.5416867917077669, 0.0836053463510975, 0.8364123240070409},
                    {0.5416787080454116, 0.08360175208588966, 0.8364179184465281},
                    {0.5416638468954322, 0.08359160243827535, 0.8364285570018775},
                    {0.5416572322296772, 0.08358515825753207, 0.8364334845595008},
                    {0.5416512602146285, 0.08357789205060813, 0.8364380779641022},
                    {0.5416459962809329, 0.08356988342758714, 0.8364422868893794},
                    {0.5416414981013493, 0.08356122013261881, 0.8364460652214665},
                    {0.5416330458265348, 0.08353228094160312, 0.8364544289495774},
                    {0.5416320120882815, 0.08352200386483992, 0.8364561245825157},
                    {0.5416318973178814, 0.08351159669463828, 0.8364572380136022},
                    {0.541637029074066, 0.08348073448390622, 0.8364569957301133},
                    {0.5416405025205852, 0.08347094268782007, 0.8364557237272361},
                    {0.5416448019120046, 0.08346158023523616, 0.8364538739143614},
                    {0.5416691925733648, 0.08343038169767465, 0.836441191732389},
                    {0.5416767541081449, 0.08342457262431748, 0.836436874331419},
                    {0, 0, 0},
                    {8.146890224116602e-05, 1.9281576196745516e-05, -5.469039026180407e-05},
                    {8.31857577119611e-05, 8.95646459158741e-06, -5.477144745126374e-05},
                    {0.5417990742882068, 0.08351908638331598, 0.8363482141489501},
                    {0.541797357432736, 0.08352941149492113, 0.8363482952061395}};
    constexpr std::uint32_t kFacets[][3] = {{0, 1, 2},   {0, 2, 3},   {0, 4, 5},    {0, 6, 7},   {0, 7, 8},
                                            {0, 9, 10},  {0, 10, 11}, {0, 11, 12},  {0, 12, 13}, {0, 14, 15},
                                            {0, 15, 16}, {0, 17, 18}, {0, 19, 20},  {0, 20, 21}, {0, 22, 23},
                                            {0, 23, 24}, {0, 25, 26}, {27, 28, 29}, {0, 30, 31}};
    for (const auto& facet : kFacets)
        shapes::add_facet(fan, {facet[0], facet[1], facet[2]});
    for (const Answer& answer :
         follow<double>(fan, {{1.0834197118774465, 0.16711950721521493, 1.672803876200265},
                              {-1.2064938859402596e-05, 9.924660593846099e-05, -2.0947058333456995e-06},
                              {9.025636066336163e-10, 1.3913788693617518e-10, 1.3935476349546202e-09}}))
        EXPECT_TRUE(answer.touching || answer.left < 2) << answer.left;
}

/// A walk that treads on the spot off the knife edge of a rim, though nothing stands between it and the probe.
TEST(GodObjectAnswer, ReachesAnOpenProbePastAKnifeEdge) {
    PolygonSoup lens;
    lens.vertices = {{-2.0000000000000018, -3.4641016151377535, 0.0},
                     {-3.4641016151377553, -1.999999999999999, 0.0},
                     {0.0, 0.0, -3.0},
                     {-7.355227538141662e-16, -4.0, 0.0},
                     {-4.0, 4.898587196589413e-16, 0.0},
                     {0.0, 0.0, -0.375},
                     {-3.464101615137755, 1.9999999999999998, 0.0},
                     {3.8125, 0.15625, -0.03125},
                     {3.2766016151377535, -2.1875000000000018, -0.1875},
                     {2.0000000000000004, -3.4641016151377544, 0.0},
                     {3.464101615137755, 1.9999999999999998, 0.0},
                     {-1.6249999999999991, 2.964101615137755, 5.84375},
                     {2.498001805406602e-16, 4.0, 0.0},
                     {2.4062500000000004, 3.4641016151377544, -0.1875}};
    const std::uint32_t rim[] = {7, 10, 13, 12, 11, 6, 4, 1, 0, 3, 9, 8};
    for (std::size_t i = 0; i < std::size(rim); ++i) {
        const std::uint32_t next = rim[(i + 1) % std::size(rim)];
        shapes::add_facet(lens, {rim[i], next, 5});
        shapes::add_facet(lens, {next, rim[i], 2});
    }
    const std::vector<Answer> answers = follow<double>(
        lens, {{-0.19140625527546884 * 8 - 0.09375, 0.37051269567469647 * 8, 0.55273436922453656 * 8 + 1.421875},
               {0.21484375527546867 * 8 - 0.09375, -1.3705126956746965 * 8, -0.90820311922453656 * 8 + 1.421875}});
    EXPECT_FALSE(answers.back().touching);
    EXPECT_LT(answers.back().left, 2);
}

} // namespace
} // namespace forceshade
