#include "plugin/lab/sweep/result_store.h"

#include <sqlite3.h>

namespace supercircle::sweep {

namespace {

constexpr const char* kSchema = R"(
PRAGMA journal_mode=WAL;
PRAGMA synchronous=FULL;
CREATE TABLE IF NOT EXISTS meta(key TEXT PRIMARY KEY, value TEXT NOT NULL);
CREATE TABLE IF NOT EXISTS runs(parameters TEXT NOT NULL, seed INTEGER NOT NULL, status TEXT NOT NULL,
  message TEXT NOT NULL, result TEXT NOT NULL, PRIMARY KEY(parameters, seed));
CREATE TABLE IF NOT EXISTS timings(parameters TEXT NOT NULL, seed INTEGER NOT NULL, host TEXT NOT NULL,
  build TEXT NOT NULL, wall_s REAL NOT NULL, cpu_s REAL NOT NULL, PRIMARY KEY(parameters, seed));
)";

} // namespace

struct ResultStore::Impl {
    sqlite3* db = nullptr;
    std::string path;

    [[nodiscard]] std::string error() const { return path + ": " + sqlite3_errmsg(db); }
    [[nodiscard]] std::string execute(const char* sql) const {
        return sqlite3_exec(db, sql, nullptr, nullptr, nullptr) == SQLITE_OK ? "" : error();
    }
};

namespace {

/// One statement, finalised at its end.
class Statement {
public:
    Statement(sqlite3* db, const char* sql) { ok_ = sqlite3_prepare_v2(db, sql, -1, &handle_, nullptr) == SQLITE_OK; }
    ~Statement() { sqlite3_finalize(handle_); }
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;

    Statement& bind(const std::string& text) {
        ok_ = ok_ &&
              sqlite3_bind_text64(handle_, ++at_, text.data(), text.size(), SQLITE_TRANSIENT, SQLITE_UTF8) == SQLITE_OK;
        return *this;
    }
    Statement& bind(std::int64_t value) {
        ok_ = ok_ && sqlite3_bind_int64(handle_, ++at_, value) == SQLITE_OK;
        return *this;
    }
    Statement& bind(double value) {
        ok_ = ok_ && sqlite3_bind_double(handle_, ++at_, value) == SQLITE_OK;
        return *this;
    }
    /// True while there is a row.
    bool step() {
        if (!ok_)
            return false;
        const int code = sqlite3_step(handle_);
        ok_ = code == SQLITE_ROW || code == SQLITE_DONE;
        return code == SQLITE_ROW;
    }
    [[nodiscard]] std::string text(int column) {
        const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(handle_, column));
        return bytes == nullptr ? std::string()
                                : std::string(bytes, static_cast<std::size_t>(sqlite3_column_bytes(handle_, column)));
    }
    [[nodiscard]] std::int64_t integer(int column) { return sqlite3_column_int64(handle_, column); }
    [[nodiscard]] double number(int column) { return sqlite3_column_double(handle_, column); }
    [[nodiscard]] bool ok() const { return ok_; }

private:
    sqlite3_stmt* handle_ = nullptr;
    int at_ = 0;
    bool ok_ = false;
};

} // namespace

ResultStore::ResultStore() : impl_(std::make_unique<Impl>()) {}

ResultStore::~ResultStore() {
    sqlite3_close(impl_->db);
}

std::string ResultStore::open(const std::string& path) {
    impl_->path = path;
    if (sqlite3_open_v2(path.c_str(), &impl_->db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr) != SQLITE_OK)
        return impl_->db != nullptr ? impl_->error() : path + ": out of memory";
    sqlite3_busy_timeout(impl_->db, 20'000);
    return impl_->execute(kSchema);
}

bool ResultStore::cannotWrite() const {
    switch (sqlite3_errcode(impl_->db)) {
    case SQLITE_FULL:
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
    case SQLITE_READONLY:
        return true;
    default:
        return false;
    }
}

Result<std::string> ResultStore::meta(const std::string& key) {
    Statement s(impl_->db, "SELECT value FROM meta WHERE key = ?");
    if (s.bind(key).step())
        return s.text(0);
    return s.ok() ? Result<std::string>(std::string{}) : Result<std::string>::failure(impl_->error());
}

std::string ResultStore::checkFormat() {
    const auto format = meta("format");
    if (!format)
        return format.error();
    if (format->empty() || *format == kStoreFormat)
        return {};
    return impl_->path + ": these results have the format " + *format + ", this version reads and writes " +
           kStoreFormat + "; run the sweep again into a new folder";
}

std::string ResultStore::setMeta(const std::string& key, const std::string& value) {
    Statement s(impl_->db, "INSERT OR REPLACE INTO meta VALUES(?, ?)");
    s.bind(key).bind(value).step();
    return s.ok() ? "" : impl_->error();
}

std::string ResultStore::save(const StoredRun& run) {
    if (std::string error = impl_->execute("BEGIN IMMEDIATE"); !error.empty())
        return error;
    bool ok = false;
    {
        Statement s(impl_->db, "INSERT OR REPLACE INTO runs VALUES(?, ?, ?, ?, ?)");
        s.bind(run.parameters).bind(run.seed).bind(run.status).bind(run.message).bind(run.result).step();
        Statement t(impl_->db, "INSERT OR REPLACE INTO timings VALUES(?, ?, ?, ?, ?, ?)");
        t.bind(run.parameters).bind(run.seed).bind(run.host).bind(run.build).bind(run.wall).bind(run.cpu).step();
        ok = s.ok() && t.ok();
    }
    std::string error = ok ? impl_->execute("COMMIT") : impl_->error();
    if (!error.empty())
        static_cast<void>(impl_->execute("ROLLBACK"));
    return error;
}

Result<std::set<RunName>> ResultStore::finished() {
    std::set<RunName> all;
    Statement s(impl_->db, "SELECT parameters, seed FROM runs WHERE status <> 'crashed'");
    while (s.step())
        all.emplace(s.text(0), s.integer(1));
    return s.ok() ? Result<std::set<RunName>>(std::move(all)) : Result<std::set<RunName>>::failure(impl_->error());
}

std::string ResultStore::forEach(const std::function<void(const StoredRun&)>& each) {
    Statement s(impl_->db, "SELECT r.parameters, r.seed, r.status, r.message, r.result, t.host, t.build, t.wall_s, "
                           "t.cpu_s FROM runs r LEFT JOIN timings t ON r.parameters = t.parameters AND r.seed = t.seed "
                           "ORDER BY r.parameters, r.seed");
    while (s.step())
        each(
            {s.text(0), s.integer(1), s.text(2), s.text(3), s.text(4), s.text(5), s.text(6), s.number(7), s.number(8)});
    return s.ok() ? "" : impl_->error();
}

std::string ResultStore::mergeFrom(ResultStore& other, const std::set<RunName>& only) {
    const auto here = finished();
    if (!here)
        return here.error();
    std::string error;
    const std::string read = other.forEach([&](const StoredRun& run) {
        const RunName name{run.parameters, run.seed};
        if (error.empty() && here->count(name) == 0 && (only.empty() || only.count(name) > 0))
            error = save(run);
    });
    return error.empty() ? read : error;
}

} // namespace supercircle::sweep
