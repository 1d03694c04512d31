#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vesalius/error.h"
#include "vesalius/frame_source.h"

namespace vesalius {

/// A source that differs from another in what is overridden.
class SourceAround : public FrameSource {
 public:
  explicit SourceAround(std::unique_ptr<FrameSource> source) : source_(std::move(source)) {}
  std::optional<Frame> next() override { return source_->next(); }
  int size() const override { return source_->size(); }
  std::optional<TimeSpan> span() const override { return source_->span(); }
  void seek(double time_s) override { source_->seek(time_s); }
  std::vector<std::string> notes() const override { return source_->notes(); }
  std::vector<SourceItem> contents() const override { return source_->contents(); }
  bool is_sequence() const override { return source_->is_sequence(); }
  bool is_live() const override { return source_->is_live(); }
  int missed() const override { return source_->missed(); }
  void stop() override { source_->stop(); }

 protected:
  FrameSource& source() { return *source_; }
  const FrameSource& source() const { return *source_; }

 private:
  std::unique_ptr<FrameSource> source_;
};

/// A source whose camera is mounted on its side or upside down.
class TurnedSource final : public SourceAround {
 public:
  /// `degrees` as SourceOptions::turn. Throws UsageError for others.
  TurnedSource(std::unique_ptr<FrameSource> source, int degrees)
      : SourceAround(std::move(source)), quarters_(degrees / kQuarter_degrees) {
    if (degrees % kQuarter_degrees == 0 && quarters_ >= 0 && quarters_ <= 3) return;
    throw UsageError("a turn of " + std::to_string(degrees) + " degrees, expected 0, 90, 180 or 270");
  }
  std::optional<Frame> next() override {
    std::optional<Frame> frame = SourceAround::next();
    if (frame) frame->quarter_turns = quarters_;
    return frame;
  }

 private:
  static constexpr int kQuarter_degrees = 90;
  int quarters_;
};

}  // namespace vesalius
