#include "supercircle/coulomb/dump.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <utility>

namespace supercircle::coulomb {

namespace {

constexpr std::string_view kMagic("FCP2D\0\0\1", 8);

/// Smallest size of a body (n = 1) and of a contact (fixed on both sides), bytes; limits a count before allocation.
constexpr std::size_t kLeastBody = 4 + 8 + 8;
constexpr std::size_t kLeastContact = 4 + 4 + 3 * 8;

template <class Number>
Number littleEndian(Number value) {
    if constexpr (std::endian::native == std::endian::little)
        return value;
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    for (std::size_t i = 0; i < sizeof value / 2; ++i)
        std::swap(raw[i], raw[sizeof value - 1 - i]);
    std::memcpy(&value, raw, sizeof value);
    return value;
}

class Writer {
public:
    explicit Writer(std::string& bytes) : bytes_(bytes) {}
    void integer(std::int32_t value) { put(value); }
    void number(double value) { put(value); }
    void numbers(const double* data, Eigen::Index count) {
        for (Eigen::Index i = 0; i < count; ++i)
            put(data[i]);
    }

private:
    template <class Number>
    void put(Number value) {
        value = littleEndian(value);
        char raw[sizeof value];
        std::memcpy(raw, &value, sizeof value);
        bytes_.append(raw, sizeof value);
    }
    std::string& bytes_;
};

/// Reads forward. After the first failure every read returns zeros, and the first message is kept.
class Reader {
public:
    explicit Reader(std::string_view bytes) : bytes_(bytes) {}

    bool ok() const { return error_.empty(); }
    const std::string& error() const { return error_; }
    std::size_t left() const { return bytes_.size() - at_; }
    void fail(const std::string& what) {
        if (ok())
            error_ = "FCP2D, byte " + std::to_string(at_) + ": " + what;
    }
    bool need(std::size_t bytes, const char* what) {
        if (ok() && left() < bytes)
            fail(std::string(what) + " needs " + std::to_string(bytes) + " bytes, " + std::to_string(left()) + " left");
        return ok();
    }
    std::int32_t integer(const char* what) { return get<std::int32_t>(what); }
    double number(const char* what) { return get<double>(what); }
    void numbers(double* data, Eigen::Index count, const char* what) {
        if (!need(static_cast<std::size_t>(count) * sizeof(double), what))
            return;
        for (Eigen::Index i = 0; i < count; ++i)
            data[i] = get<double>(what);
    }
    void magic() {
        if (bytes_.substr(0, kMagic.size()) != kMagic)
            fail("not an FCP2D file, version 1");
        else
            at_ = kMagic.size();
    }

private:
    template <class Number>
    Number get(const char* what) {
        Number value{};
        if (!need(sizeof value, what))
            return value;
        std::memcpy(&value, bytes_.data() + at_, sizeof value);
        at_ += sizeof value;
        return littleEndian(value);
    }
    std::string_view bytes_;
    std::size_t at_ = 0;
    std::string error_;
};

void readBody(Reader& in, Body& body) {
    const std::int32_t n = in.integer("size of a body");
    if (in.ok() && n <= 0)
        in.fail("a body needs at least one freedom, not " + std::to_string(n));
    // Checked by division: n * n * 8 could overflow, and no memory is allocated for missing bytes.
    if (in.ok() && static_cast<std::size_t>(n) + 1 > in.left() / sizeof(double) / static_cast<std::size_t>(n))
        in.fail("a body of " + std::to_string(n) + " freedoms does not fit into the " + std::to_string(in.left()) +
                " bytes left");
    if (!in.ok())
        return;
    body.A.resize(n, n);
    body.vFree.resize(n);
    in.numbers(body.A.data(), body.A.size(), "A");
    in.numbers(body.vFree.data(), n, "vfree");
}

void readRows(Reader& in, const Problem& problem, std::int32_t body, Eigen::Matrix<double, 2, Eigen::Dynamic>& H) {
    if (!in.ok() || body == -1)
        return;
    if (body < 0 || static_cast<std::size_t>(body) >= problem.bodies.size())
        return in.fail("no body " + std::to_string(body));
    const Eigen::Index n = problem.bodies[static_cast<std::size_t>(body)].vFree.size();
    if (!in.need(static_cast<std::size_t>(2 * n) * sizeof(double), "a contact row"))
        return;
    H.resize(2, n);
    in.numbers(H.data(), H.size(), "a contact row");
}

void readContact(Reader& in, const Problem& problem, Contact& contact) {
    contact.a = in.integer("body a");
    contact.b = in.integer("body b");
    contact.mu = in.number("mu");
    in.numbers(contact.w.data(), 2, "w");
    readRows(in, problem, contact.a, contact.Ha);
    readRows(in, problem, contact.b, contact.Hb);
}

void readKinds(Reader& in, Problem& problem) {
    for (Contact& contact : problem.contacts) {
        const std::int32_t kind = in.integer("kind of a contact");
        if (in.ok() && kind != 0 && kind != 1)
            in.fail("no kind of contact " + std::to_string(kind));
        contact.kind = kind == 1 ? ContactKind::Bilateral : ContactKind::Unilateral;
    }
}

} // namespace

std::string encode(const Problem& problem, std::string& bytes) {
    if (std::string error = validate(problem); !error.empty())
        return "FCP2D cannot hold this problem: " + error;
    bytes.assign(kMagic);
    Writer out(bytes);
    out.integer(static_cast<std::int32_t>(problem.bodies.size()));
    out.integer(static_cast<std::int32_t>(problem.contacts.size()));
    const bool kinds = std::any_of(problem.contacts.begin(), problem.contacts.end(),
                                   [](const Contact& contact) { return contact.bilateral(); });
    out.integer(problem.r0.size() > 0 ? 1 : 0);
    out.integer(kinds ? 1 : 0);
    out.number(problem.dt);
    for (const Body& body : problem.bodies) {
        out.integer(static_cast<std::int32_t>(body.vFree.size()));
        out.numbers(body.A.data(), body.A.size());
        out.numbers(body.vFree.data(), body.vFree.size());
    }
    for (const Contact& contact : problem.contacts) {
        out.integer(contact.a);
        out.integer(contact.b);
        out.number(contact.mu);
        out.numbers(contact.w.data(), 2);
        if (contact.a >= 0)
            out.numbers(contact.Ha.data(), contact.Ha.size());
        if (contact.b >= 0)
            out.numbers(contact.Hb.data(), contact.Hb.size());
    }
    out.numbers(problem.r0.data(), problem.r0.size());
    for (std::size_t c = 0; kinds && c < problem.contacts.size(); ++c)
        out.integer(problem.contacts[c].bilateral() ? 1 : 0);
    return {};
}

std::string decode(std::string_view bytes, Problem& problem) {
    Reader in(bytes);
    in.magic();
    Problem read;
    const std::int32_t bodies = in.integer("number of bodies");
    const std::int32_t contacts = in.integer("number of contacts");
    const std::int32_t warm = in.integer("warm start flag");
    const std::int32_t kinds = in.integer("kinds flag");
    read.dt = in.number("dt");
    if (in.ok() && (bodies < 0 || contacts < 0 || warm < 0 || warm > 1 || kinds < 0 || kinds > 1))
        in.fail("impossible header: " + std::to_string(bodies) + " bodies, " + std::to_string(contacts) +
                " contacts, flags " + std::to_string(warm) + " " + std::to_string(kinds));
    if (!in.ok() || !in.need(static_cast<std::size_t>(bodies) * kLeastBody, "the bodies"))
        return in.error();
    read.bodies.resize(static_cast<std::size_t>(bodies));
    for (Body& body : read.bodies)
        readBody(in, body);
    if (!in.need(static_cast<std::size_t>(contacts) * kLeastContact, "the contacts"))
        return in.error();
    read.contacts.resize(static_cast<std::size_t>(contacts));
    for (Contact& contact : read.contacts)
        readContact(in, read, contact);
    if (warm == 1 && in.need(static_cast<std::size_t>(contacts) * 16, "the warm start")) {
        read.r0.resize(2 * contacts);
        in.numbers(read.r0.data(), read.r0.size(), "the warm start");
    }
    if (kinds == 1)
        readKinds(in, read);
    if (in.ok() && in.left() > 0)
        in.fail(std::to_string(in.left()) + " bytes too many");
    if (!in.ok())
        return in.error();
    if (std::string error = validate(read); !error.empty())
        return "FCP2D: " + error;
    problem = std::move(read);
    return {};
}

std::string writeDump(const std::string& path, const Problem& problem) {
    std::string bytes;
    if (std::string error = encode(problem, bytes); !error.empty())
        return error;
    std::ofstream file(path, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    return file ? std::string() : "cannot write " + path;
}

std::string readDump(const std::string& path, Problem& problem) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        return "cannot open " + path;
    const std::string bytes{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
    if (file.bad())
        return "cannot read " + path;
    const std::string error = decode(bytes, problem);
    return error.empty() ? error : path + ": " + error;
}

} // namespace supercircle::coulomb
