#include <catch2/catch.hpp>

#include <csignal>
#include <cstdlib>
#include <filesystem>

#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "plugin/recording/table/files.h"
#include "plugin/recording/table/writer.h"
#include "tests/plugin/recording/table/example.h"
#include "tests/support/folder.h"

using namespace supercircle;
using namespace supercircle::record;
namespace fs = std::filesystem;

using supercircle::test::Folder;

TEST_CASE("files are written whole, replaced, and readable by others") {
    const Folder folder;
    const std::string deep = folder.path + "/a/b";
    CHECK(writeAtomically(deep, {{"x", "one"}, {"y", ""}}));
    CHECK(writeAtomically(deep, {{"x", "two"}}));
    CHECK(readText(deep + "/x").value() == "two");
    CHECK(readText(deep + "/y").value().empty());
    CHECK(std::distance(fs::directory_iterator(deep), fs::directory_iterator()) == 2);
    const mode_t mask = ::umask(0);
    ::umask(mask);
    CHECK((static_cast<unsigned>(fs::status(deep + "/x").permissions()) & 0777U) == (0666U & ~mask));
}

TEST_CASE("a place that cannot be written is an error message") {
    const Folder folder;
    REQUIRE(writeAtomically(folder.path, {{"file", "x"}}));
    CHECK_THAT(writeAtomically(folder.path + "/file/sub", {{"a", "b"}}).error(),
               Catch::Contains("cannot make the directory"));
    CHECK_THAT(writeAtomically(folder.path + "/file", {{"a", "b"}}).error(), Catch::Contains("/file"));
    CHECK_THAT(writeAtomically("/proc", {{"a", "b"}}).error(), Catch::Contains("cannot write /proc/a"));
    CHECK_THAT(writeFiles(test::smallRecording(), "/proc/none").error(), Catch::Contains("/proc/none"));
}

TEST_CASE("a too large file leaves the old one and no temporary files") {
    const Folder folder;
    REQUIRE(writeAtomically(folder.path, {{"x", "old"}, {"y", "old"}}));
    // The nearest thing to a full disk that needs no privilege: a limit on file size (EFBIG instead of ENOSPC).
    rlimit before{};
    REQUIRE(::getrlimit(RLIMIT_FSIZE, &before) == 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, before.rlim_max};
    REQUIRE(::setrlimit(RLIMIT_FSIZE, &limit) == 0);
    const std::string message = writeAtomically(folder.path, {{"x", "new"}, {"y", std::string(100000, 'z')}}).error();
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    CHECK_THAT(message, Catch::Contains("cannot write") && Catch::Contains("/y"));
    CHECK(readText(folder.path + "/x").value() == "old");
    CHECK(readText(folder.path + "/y").value() == "old");
    CHECK(folder.entries() == 2);
}

TEST_CASE("a full disk leaves the old files and no temporary files") {
    const Folder folder;
    if (::mount("tmpfs", folder.path.c_str(), "tmpfs", 0, "size=64k") != 0) {
        WARN("no permission to mount a small disk: not tested");
        return;
    }
    CHECK(writeAtomically(folder.path, {{"x", "old"}}));
    CHECK_THAT(writeAtomically(folder.path, {{"x", std::string(1 << 20, 'z')}}).error(),
               Catch::Contains("No space left"));
    CHECK(readText(folder.path + "/x").value() == "old");
    CHECK(folder.entries() == 1);
    CHECK(::umount(folder.path.c_str()) == 0);
}
