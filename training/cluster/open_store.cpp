#include "cluster/folder_store.h"
#include "cluster/store.h"
#include "cluster/webhdfs_store.h"
#include "vesalius/error.h"

namespace vesalius {

std::unique_ptr<Store> open_store(const std::string& place) {
  if (WebHdfsStore::takes(place)) return std::make_unique<WebHdfsStore>(place);
  if (place.find("://") != place.npos) {
    throw UsageError(place + ": expected a folder, or an address webhdfs://HOST:PORT/PATH");
  }
  return std::make_unique<FolderStore>(place);
}

}  // namespace vesalius
