#pragma once

#include "cluster/store.h"
#include "downloads/web_connection.h"

namespace vesalius {

/// How HDFS is asked: its own read timeout is 60 s.
inline WebOptions webhdfs_options() { return {.stall_s = 60.0, .tries = 5, .direct = true}; }

/// A folder of HDFS, by WebHDFS of Hadoop 3. The user is HADOOP_USER_NAME of the environment, else USER, LOGNAME, or
/// whom this process belongs to; clusters that ask for Kerberos or TLS are not supported. Nodes are asked directly,
/// whatever proxies the environment names.
/// A writer that is killed may leave a file with ".tmp-" in its name, which list() leaves out.
class WebHdfsStore : public Store {
 public:
  /// Returns whether `place` begins as an address of this kind does.
  static bool takes(const std::string& place);

  /// Asks nobody yet. Throws UsageError unless the address is webhdfs://HOST:PORT/PATH, its path of the same characters
  /// as names.
  explicit WebHdfsStore(const std::string& address, WebOptions options = webhdfs_options());

  std::string place() const override { return address_ + path_of(""); }
  std::string read(const std::string& name) const override;
  bool exists(const std::string& name) const override;
  void write(const std::string& name, const std::string& bytes) override;
  std::vector<std::string> list(const std::string& folder) const override;
  void remove(const std::string& name) override;

 private:
  class Call;

  /// Absolute in HDFS; of the store itself for the empty name.
  std::string path_of(const std::string& name) const;
  /// Removes what an interrupted write() left, if it can.
  void discard(const std::string& name) const;

  std::string address_;  ///< webhdfs://HOST:PORT
  std::string root_;     ///< absolute path; empty for HDFS's root
  std::string user_;
  WebOptions options_;
};

}  // namespace vesalius
