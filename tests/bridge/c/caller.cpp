#include "tests/bridge/c/caller.h"

namespace supercircle::fuzz {

namespace {

/// With room behind the zero, so that a call may be told of more bytes than the text has.
using Text = std::array<char, 2048>;

Text padded(const char* text) {
    Text t{};
    std::strncpy(t.data(), text, t.size() - 1);
    return t;
}

const std::vector<Text>& texts() {
    static const std::vector<Text> all = {
        padded("a"),
        padded("b"),
        padded("plate"),
        padded(""),
        padded("\xff\xfe{"),
        padded("{}"),
        padded("[]"),
        padded("{\"key\": \"planar_drag\", \"f_N_m\": 0.2}"),
        padded("[{\"key\": \"planar_drag\", \"f_N_m\": 0.2}, {\"key\": \"plasticity\"}]"),
        padded("planar_drag"),
        padded("{\"mu\": 0.3}"),
        padded("[[[[[[[[[[[[[[[[[[[["),
        padded("{\"schema\": \"supercircle-scene/1\", \"body\": [{\"name\": \"plate\", \"type\": 1, \"position\": "
               "{\"x\": 0, \"y\": -0.02}, \"fixture\": [{\"polygon\": {\"vertices\": {\"x\": [-0.3, 0.3, 0.3, -0.3], "
               "\"y\": [-0.01, -0.01, 0.01, 0.01]}}}]}, {\"name\": \"b\", \"type\": 2, \"position\": {\"x\": 0.1, "
               "\"y\": 0.1}, \"fixture\": [{\"density\": 1, \"circle\": {\"center\": {\"x\": 0, \"y\": 0}, \"radius\": "
               "0.02}}]}]}"),
        padded("{\"schema\": \"supercircle-scene/1\", \"shell\": [{\"name\": \"a\", \"position\": {\"x\": 0, \"y\": "
               "0.05}, \"elements\": 6}], \"duration\": 0.1}"),
    };
    return all;
}

} // namespace

std::uint64_t Caller::handle(Kind kind) {
    const int luck = bytes_.byte();
    if (luck < 4)
        return 0;
    if (luck < 8)
        return std::uint64_t{bytes_.below(5)} << 52 | std::uint64_t{bytes_.below(5)} << 32 | bytes_.below(200);
    const std::vector<std::uint64_t>& mine =
        pool(luck < 14 ? static_cast<Kind>(bytes_.below(static_cast<std::uint32_t>(Kind::Count))) : kind);
    return mine.empty() ? 0 : mine[bytes_.below(static_cast<std::uint32_t>(mine.size()))];
}

void Caller::keep(Kind kind, std::uint64_t id) {
    std::vector<std::uint64_t>& ids = pool(kind);
    for (const std::uint64_t known : ids)
        if (known == id)
            return;
    ids.push_back(id);
    if (ids.size() > 12 && kind != Kind::World)
        ids.erase(ids.begin());
}

void Caller::remember(const std::string& call) {
    history += (call == "refused" ? " " : ", ") + call + bytes_.takeOddNumbers();
    if (history.size() > 800)
        history.erase(0, history.find(", ", history.size() - 400));
}

double Caller::number() {
    static constexpr std::array<double, 6> kReach{1.0, 1.0, 0.3, 0.02, 1e-4, 50.0};
    const double reach = kReach[bytes_.below(6)];
    return bytes_.number(bytes_.chance(80) ? -reach : 0.0, reach, kOdd);
}

const char* Caller::text() {
    const auto& all = texts();
    return all[bytes_.below(static_cast<std::uint32_t>(all.size()))].data();
}

void Caller::check(const char* name, std::int64_t result, bool isCount) {
    if (std::strcmp(name, "sc_api_version") == 0) // cannot be refused, and leaves the sentence of an earlier call
        return;
    const std::string error = sc_error();
    if (error.empty()) {
        if (isCount && result < 0)
            violation = std::string(name) + " was refused without a sentence";
        return;
    }
    ++refused;
    const std::int64_t status = result < 0 ? -result : result;
    if (sc_error_status() == SC_OK || (isCount && status != 0 && sc_error_status() != status))
        violation = std::string(name) + " says " + std::to_string(result) + ", sc_error_status() " +
                    std::to_string(sc_error_status());
    if (isCount && (status > SC_WRONG_VERSION || status == SC_BUSY || status == SC_NO_MEMORY))
        violation = std::string(name) + " says " + std::to_string(result) + ": " + error;
    if (isCount && status == SC_FAILED && std::strstr(name, "_step") == nullptr)
        violation = std::string(name) + " failed: " + error;
}

void Caller::fill(double& d) {
    d = number();
}
void Caller::fill(sc_point& p) {
    const Point at = bytes_.point(0.25, kOdd);
    p = {at.x, at.y};
}
void Caller::fill(sc_world_def& d) {
    sc_world_def_init(&d);
    d.quality = SC_QUALITY_GAME;
    d.units_per_metre = bytes_.number(10.0, 60.0, kOdd);
    if (bytes_.chance(kOdd))
        d.size = static_cast<std::int32_t>(bytes_.below(200));
}
void Caller::fill(sc_shell_def& d) {
    const int odd = bytes_.chance(60) ? 30 : 0;
    sc_shell_def_init(&d);
    fill(d.position);
    d.angle = bytes_.number(-7.0, 7.0, odd);
    d.opening = bytes_.number(0.1, 1.0, odd);
    d.radius = bytes_.number(0.005, 0.05, odd);
    d.thickness = bytes_.number(2e-4, 3e-3, odd);
    d.elements = static_cast<std::int32_t>(bytes_.below(12)) - (odd > 0 ? 2 : -1);
    d.friction = bytes_.number(0.0, 1.0, odd);
    d.velocity = {bytes_.number(-1.0, 1.0, odd), bytes_.number(-1.0, 1.0, odd)};
    d.spin = bytes_.number(-40.0, 40.0, odd);
    d.young_modulus = bytes_.number(1e8, 3e9, odd);
    d.density = bytes_.number(500.0, 2000.0, odd);
    d.closed = bytes_.chance(30) ? 1 : 0;
    if (bytes_.chance(kOdd))
        d.size = static_cast<std::int32_t>(bytes_.below(400));
}
void Caller::fill(sc_body_def& d) {
    sc_body_def_init(&d);
    d.type = static_cast<std::int32_t>(bytes_.below(bytes_.chance(10) ? 5 : 3));
    d.shape = static_cast<std::int32_t>(bytes_.below(bytes_.chance(10) ? 6 : 4));
    d.fixed_rotation = bytes_.chance(30) ? 1 : 0;
    d.bullet = bytes_.chance(30) ? 1 : 0;
    fill(d.position);
    d.angle = bytes_.number(-7.0, 7.0, kOdd);
    d.velocity = {bytes_.number(-1.0, 1.0, kOdd), bytes_.number(-1.0, 1.0, kOdd)};
    d.spin = bytes_.number(-40.0, 40.0, kOdd);
    d.width = bytes_.number(0.0, 0.1, kOdd);
    d.height = bytes_.number(0.0, 0.1, kOdd);
    d.radius = bytes_.number(0.0, 0.05, kOdd);
    d.density = bytes_.number(0.0, 5.0, kOdd);
    d.friction = bytes_.number(0.0, 1.0, kOdd);
    d.restitution = bytes_.number(0.0, 1.0, kOdd);
    d.linear_damping = bytes_.number(0.0, 1.0, kOdd);
    d.angular_damping = bytes_.number(0.0, 1.0, kOdd);
    d.gravity_scale = bytes_.number(-1.0, 2.0, kOdd);
    d.category = 1U << bytes_.below(3);
    if (bytes_.chance(kOdd))
        d.size = static_cast<std::int32_t>(bytes_.below(400));
}
void Caller::fill(sc_joint_def& d) {
    sc_joint_def_init(&d);
    d.kind = static_cast<std::int32_t>(bytes_.below(bytes_.chance(10) ? 7 : 3));
    fill(d.shell);
    if (bytes_.chance(100))
        fill(d.other);
    if (bytes_.chance(100))
        fill(d.body);
    d.arc_fraction = bytes_.number(0.0, 1.0, kOdd);
    d.other_fraction = bytes_.number(0.0, 1.0, kOdd);
    fill(d.point);
    d.length = bytes_.chance(100) ? 0.0 : bytes_.number(0.0, 0.5, kOdd);
}
void Caller::fill(sc_mouse_joint_def& d) {
    sc_mouse_joint_def_init(&d);
    d.arc_fraction = bytes_.number(0.0, 1.0, kOdd);
    fill(d.target);
    d.frequency = bytes_.number(0.1, 50.0, kOdd);
    d.damping_ratio = bytes_.number(0.0, 2.0, kOdd);
    d.max_force = bytes_.number(0.0, 1.0, kOdd);
}
void Caller::fill(sc_material& d) {
    d = {bytes_.number(0.0, 1.0, kOdd), bytes_.number(1e8, 3e9, kOdd), bytes_.number(500.0, 2000.0, kOdd),
         bytes_.number(0.0, 0.3, kOdd)};
}
void Caller::fill(sc_target& d) {
    fill(d.position);
    d.angle = bytes_.number(-3.0, 3.0, kOdd);
    d.velocity = {bytes_.number(-0.1, 0.1, kOdd), bytes_.number(-0.1, 0.1, kOdd)};
    d.spin = bytes_.number(-1.0, 1.0, kOdd);
}
void Caller::fill(sc_filter& d) {
    d = {1U << bytes_.below(3), bytes_.chance(60) ? bytes_.below(8) : 0xffffU,
         static_cast<std::int32_t>(bytes_.below(5)) - 2, 0};
}
void Caller::fill(sc_sleep& d) {
    d = {bytes_.chance(128) ? 1 : 0, 0, bytes_.number(0.01, 10.0, kOdd), bytes_.number(0.0, 0.1, kOdd)};
}
void Caller::fill(sc_recovery& d) {
    d = {bytes_.chance(128) ? 1 : 0, 0, bytes_.number(0.0, 0.1, kOdd)};
}
void Caller::fill(sc_event_settings& d) {
    d = {bytes_.number(0.0, 1e-3, 30), bytes_.number(1e-3, 0.1, 30), bytes_.number(1e-3, 0.3, 30)};
}
void Caller::fill(sc_view& d) {
    sc_view_init(&d);
    d.width = static_cast<std::int32_t>(bytes_.below(1000));
    d.pixels_per_metre = bytes_.number(0.0, 1e4, kOdd);
    d.alpha = bytes_.number(0.0, 1.0, kOdd);
}

} // namespace supercircle::fuzz
