// The engine `slurm` on a Slurm of one node that the test starts and stops.

#include "tests/plugin/cli/program.h"

#include <catch2/catch.hpp>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <thread>
#include <unistd.h>

using namespace supercircle::test;
using Catch::Contains;

namespace {

std::string here() {
    char name[256] = {};
    ::gethostname(name, sizeof name - 1);
    const std::string all = name;
    return all.substr(0, all.find('.'));
}

bool shell(const std::string& command) {
    return std::system((command + " >/dev/null 2>&1").c_str()) == 0; // NOLINT: fixed texts
}

/// munged, slurmctld and slurmd with all their files in one folder; ended by their ids.
class Cluster {
public:
    explicit Cluster(std::string folder) : folder_(std::move(folder)) {
        const int port = 20000 + static_cast<int>(::getpid() % 20000);
        std::ofstream(folder_ + "/slurm.conf")
            << "ClusterName=test\nSlurmctldHost=" << here() << "(127.0.0.1)\nSlurmUser=root\nSlurmdUser=root\n"
            << "SlurmctldPort=" << port << "\nSlurmdPort=" << port + 1
            << "\nAuthType=auth/munge\nAuthInfo=socket=" << folder_
            << "/munge.socket\nCredType=cred/munge\nStateSaveLocation=" << folder_
            << "/state\nSlurmdSpoolDir=" << folder_ << "/spool\nSlurmctldPidFile=" << folder_
            << "/slurmctld.pid\nSlurmdPidFile=" << folder_ << "/slurmd.pid\nSlurmctldLogFile=" << folder_
            << "/slurmctld.log\nSlurmdLogFile=" << folder_
            << "/slurmd.log\nProctrackType=proctrack/pgid\nTaskPlugin=task/none\n"
               "JobAcctGatherType=jobacct_gather/none\nAccountingStorageType=accounting_storage/none\n"
               "SelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\nSwitchType=switch/none\nMpiDefault=none\n"
               "ReturnToService=2\nKillWait=2\nMinJobAge=10\nNodeName="
            << here()
            << " NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN\n"
               "PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n";
        ::setenv("SLURM_CONF", (folder_ + "/slurm.conf").c_str(), 1);
        std::filesystem::create_directory(folder_ + "/state");
        std::filesystem::create_directory(folder_ + "/spool");
        shell("head -c 1024 /dev/urandom > " + folder_ + "/munge.key; chmod 400 " + folder_ + "/munge.key");
        shell("munged --force --key-file=" + folder_ + "/munge.key --socket=" + folder_ + "/munge.socket --pid-file=" +
              folder_ + "/munged.pid --log-file=" + folder_ + "/munged.log --seed-file=" + folder_ + "/munge.seed");
        shell("slurmctld -c");
        shell("slurmd -N " + here());
        for (int i = 0; i < 300 && !ready; ++i) {
            ready = shell("sinfo --noheader --states=idle --format=%n | grep -q .");
            std::this_thread::sleep_for(std::chrono::milliseconds(100));
        }
    }
    ~Cluster() {
        shell("scancel --me; sleep 1");
        for (const char* name : {"slurmd", "slurmctld", "munged"}) {
            std::ifstream in(folder_ + "/" + name + ".pid");
            if (pid_t id = 0; in >> id) {
                ::kill(id, SIGTERM);
                for (int i = 0; i < 100 && ::kill(id, 0) == 0; ++i)
                    std::this_thread::sleep_for(std::chrono::milliseconds(50));
            }
        }
        ::unsetenv("SLURM_CONF");
    }
    Cluster(const Cluster&) = delete;
    Cluster& operator=(const Cluster&) = delete;
    bool ready = false;

private:
    std::string folder_;
};

std::string sweepFile(const Folder& folder, int seeds) {
    return folder.write("sweep.json", R"({"schema": "supercircle-sweep/1", "scene": ")" +
                                          supercircle::test::scene("shell_on_cylinder") +
                                          R"(", "grid": {"phi_bar": [0.65, 0.75], "mu": [0.1, 0.35]},
        "fixed": {"elements": 8, "speed": 0.02}, "seeds": {"last": )" +
                                          std::to_string(seeds) + "}}");
}

CommandResult sweepInto(const std::string& file, const std::string& out, std::vector<std::string> more,
                        const Start& how = {}) {
    more.insert(more.begin(), {"sweep", file, "--out", out, "--quiet", "--resume"});
    return start(more, how);
}

std::string tables(const std::string& out) {
    return contentOf(out + "/results.csv") + contentOf(out + "/statistics.csv") + contentOf(out + "/failed.csv");
}

/// The test needs Slurm and root rights (for munged and slurmd).
bool possible() {
    if (::getuid() == 0 && shell("PATH=$PATH:/usr/sbin which slurmctld slurmd munged sbatch"))
        return true;
    WARN("no Slurm here (Debian: slurm-wlm, munge), or not root: not tested");
    return false;
}

} // namespace

TEST_CASE("without Slurm's commands the engine says what is missing") {
    const Folder folder;
    const std::string path = std::getenv("PATH");
    ::setenv("PATH", folder.path().c_str(), 1);
    const CommandResult ending = sweepInto(sweepFile(folder, 1), folder / "out", {"--engine", "slurm"});
    ::setenv("PATH", path.c_str(), 1);
    CHECK(ending.code == 3);
    CHECK_THAT(ending.err, Contains("squeue: not found"));
}

TEST_CASE("a sweep on Slurm gives the bytes of a local one, also when processes are killed", "[slow]") {
    if (!possible())
        return;
    ::setenv("PATH", (std::string(std::getenv("PATH")) + ":/usr/sbin:/sbin").c_str(), 1);
    const Folder folder, daemons;
    const std::string file = sweepFile(folder, 50);
    REQUIRE(sweepInto(file, folder / "home", {}).code == 0);
    const Cluster cluster(daemons.path());
    REQUIRE(cluster.ready);
    const std::vector<std::string> onCluster = {"--engine", "slurm", "--jobs", "2"};
    {
        const CommandResult ending = sweepInto(file, folder / "cluster", onCluster);
        INFO(ending.err);
        REQUIRE(ending.code == 0);
        CHECK(tables(folder / "cluster") == tables(folder / "home"));
    }
    std::mt19937 random(5); // NOLINT: a fixed seed
    std::uniform_real_distribution<double> delay(0.3, 1.2);
    int killed = 0;
    for (const char* name : {"torn", "torn again"}) {
        for (int i = 0; i < 25; ++i) { // the waiting program killed, and every other time the tasks, too
            const CommandResult ending =
                sweepInto(file, folder / name, onCluster, {.signal = SIGKILL, .signalAfter = delay(random)});
            killed += ending.code == 128 + SIGKILL ? 1 : 0;
            if (i % 2 == 0) {
                shell("scancel --signal=KILL --full --me");
                for (int k = 0; k < 100 && shell("squeue --me --noheader | grep -q ."); ++k)
                    std::this_thread::sleep_for(std::chrono::milliseconds(100));
            }
        }
        CommandResult last = sweepInto(file, folder / name, onCluster); // may wait for an array that is still there ...
        if (last.code != 0)
            last = sweepInto(file, folder / name, onCluster); // ... and lost tasks to a kill
        INFO(last.err);
        REQUIRE(last.code == 0);
        CHECK(tables(folder / name) == tables(folder / "home"));
    }
    WARN(killed << " of 50 kills came before their sweep had ended");
    CHECK(killed > 25);
}
