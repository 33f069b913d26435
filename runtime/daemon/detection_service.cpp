// SPDX-License-Identifier: Apache-2.0
#include "runtime/daemon/detection_service.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <utility>

#include "runtime/base/error.h"

namespace sextant {

namespace {

using Clock = DetectionService::Clock;

constexpr double kLongestDeadlineMs = 600'000;
constexpr double kLargestThreshold = 1e9;
constexpr std::size_t kMostLooks = 64;
constexpr std::size_t kMostModels = 1000;

/// One model, without its parts: the detector holds them.
struct Known {
  std::string name;
  int object_id = 0;
  std::filesystem::path file;
  bool enabled = true;
  std::optional<double> threshold;
};

/// Detection as it is between two commands. Never changed in place: a frame under way keeps its own.
struct State {
  std::vector<Known> models;  // in the detector's order
  DetectOptions options;
  std::vector<std::filesystem::path> folders;
  double max_look_age_ms = 0;
  ImageRegion region{};
  std::optional<double> deadline_ms;   // instead of the options'
  std::shared_ptr<Detector> detector;  // of all models; none without models

  std::optional<std::size_t> find(const std::string& name) const {
    for (std::size_t i = 0; i < models.size(); ++i) {
      if (models[i].name == name) return i;
    }
    return std::nullopt;
  }
  std::vector<ObjectModel> copy_of_models() const {
    return detector ? detector->models() : std::vector<ObjectModel>{};
  }
  void make_detector(std::vector<ObjectModel> of) {
    detector = of.empty() ? nullptr : std::make_shared<Detector>(std::move(of), options);
  }
};

Known known(const LoadedModel& loaded) {
  return {loaded.model.name, loaded.model.object_id, loaded.file, true, {}};
}

State begin(DetectionSetup setup) {
  State state;
  state.options = std::move(setup.options);
  state.folders = std::move(setup.model_folders);
  state.max_look_age_ms = setup.max_look_age_ms;
  std::vector<ObjectModel> models;
  for (LoadedModel& loaded : setup.models) {
    state.models.push_back(known(loaded));
    models.push_back(std::move(loaded.model));
  }
  state.make_detector(std::move(models));
  return state;
}

struct Look {
  Command command;
  std::function<void(const CommandAnswer&)> answer;
  Clock::time_point asked_at, patience_ends;
};

/// The message of a command that makes no sense.
[[noreturn]] void refuse(const std::string& what, const std::string& advice = "") {
  throw UsageError(what, advice);
}

}  // namespace

struct DetectionService::Impl {
  ModelsChanged models_changed;
  SearchElsewhere search_elsewhere;
  std::atomic<bool> cancelled = false;
  std::mutex change_mutex;   // one change at a time
  mutable std::mutex mutex;  // guards the rest
  cv::Size image_size;       // of the last frame; empty before the first
  std::shared_ptr<const State> state;
  std::vector<Look> looks;

  std::shared_ptr<const State> now() const {
    const std::lock_guard lock(mutex);
    return state;
  }
  void set(State next) {
    auto made = std::make_shared<const State>(std::move(next));
    const std::lock_guard lock(mutex);
    state = std::move(made);
  }

  std::vector<Look> looks_for(const RgbdFrame& frame) {
    const std::lock_guard lock(mutex);
    const auto ready = std::stable_partition(looks.begin(), looks.end(), [&](const Look& look) {
      return frame.captured_monotonic < look.asked_at;
    });
    std::vector<Look> found(std::make_move_iterator(ready), std::make_move_iterator(looks.end()));
    looks.erase(ready, looks.end());
    return found;
  }

  cv::Size last_image_size() const {
    const std::lock_guard lock(mutex);
    return image_size;
  }
  void remember(const RgbdFrame& frame) {
    const std::lock_guard lock(mutex);
    image_size = frame.colour.size();
  }

  /// Indices of the objects that a command means.
  static std::vector<std::size_t> meant(const State& s, const std::string& name) {
    std::vector<std::size_t> all;
    if (name.empty()) {
      for (std::size_t i = 0; i < s.models.size(); ++i) all.push_back(i);
      return all;
    }
    const auto index = s.find(name);
    if (!index) {
      std::vector<std::string> names;
      for (const Known& model : s.models) names.push_back(model.name);
      refuse(fmt::format("no object is called '{}'", name),
             names.empty() ? "load its model first" : fmt::format("loaded are: {}", fmt::join(names, ", ")));
    }
    return {*index};
  }

  /// Changes the copy `s` of the state; returns what was done, in words. Throws without having changed
  /// anything that counts.
  static std::string change(State& s, const Command& c, const cv::Size& image, bool& models_differ) {
    const std::string whom = c.object_name.empty() ? "every object" : c.object_name;
    switch (c.kind) {
      case CommandKind::kStatus:
        return fmt::format("{} object{} loaded", s.models.size(), s.models.size() == 1 ? "" : "s");
      case CommandKind::kLoad: {
        if (c.model_file.empty()) refuse("model_file is empty", "name a file made by `sextant compile`");
        if (s.models.size() >= kMostModels) refuse("too many models");
        const std::filesystem::path file = allowed_model_file(c.model_file, s.folders);
        LoadedModel loaded = load_models({file})[0];
        const std::string name = loaded.model.name;
        std::vector<ObjectModel> models = s.copy_of_models();
        if (const auto old = s.find(name)) {
          s.models[*old] = known(loaded);
          models[*old] = std::move(loaded.model);
        } else {
          s.models.push_back(known(loaded));
          models.push_back(std::move(loaded.model));
        }
        s.make_detector(std::move(models));
        models_differ = true;
        return fmt::format("loaded {} from {}", name, file.string());
      }
      case CommandKind::kUnload: {
        if (c.object_name.empty()) refuse("object_name is empty", "name the object to forget");
        const auto index = static_cast<std::ptrdiff_t>(meant(s, c.object_name)[0]);
        std::vector<ObjectModel> models = s.copy_of_models();
        s.models.erase(s.models.begin() + index);
        models.erase(models.begin() + index);
        s.make_detector(std::move(models));
        models_differ = true;
        return "forgot " + c.object_name;
      }
      case CommandKind::kEnable:
      case CommandKind::kDisable: {
        const bool on = c.kind == CommandKind::kEnable;
        for (const std::size_t i : meant(s, c.object_name)) s.models[i].enabled = on;
        return fmt::format("{} {}", on ? "looking for" : "no longer looking for", whom);
      }
      case CommandKind::kRegion: {
        if (c.region != ImageRegion{} && (c.region[2] < 1 || c.region[3] < 1)) {
          refuse(fmt::format("a region of {} x {} pixels is too small", c.region[2], c.region[3]),
                 "use at least 1 x 1, or 0 0 0 0 for the whole image");
        }
        if (!image.empty() && (c.region[0] >= static_cast<std::uint32_t>(image.width) ||
                               c.region[1] >= static_cast<std::uint32_t>(image.height))) {
          refuse(fmt::format("the region from {}, {} does not lie inside the image of {} x {} pixels",
                             c.region[0], c.region[1], image.width, image.height),
                 "give x, y, width and height in pixels, or 0 0 0 0 for the whole image");
        }
        s.region = c.region;
        if (c.region == ImageRegion{}) return "looking at the whole image";
        return fmt::format("looking at {} x {} pixels from {}, {}", c.region[2], c.region[3], c.region[0],
                           c.region[1]);
      }
      case CommandKind::kThreshold: {
        const bool back = std::isnan(c.value);
        if (!back && std::abs(c.value) > kLargestThreshold)
          refuse("the threshold is absurd", "use -1e9 to 1e9");
        for (const std::size_t i : meant(s, c.object_name))
          s.models[i].threshold = back ? std::nullopt : std::optional(c.value);
        return back ? fmt::format("the threshold of {} is as configured", whom)
                    : fmt::format("the threshold of {} is {:.6g}", whom, c.value);
      }
      case CommandKind::kDeadline: {
        const bool back = std::isnan(c.value);
        if (!back && !(c.value >= 0 && c.value <= kLongestDeadlineMs))
          refuse("the deadline is not 0 to 600000 ms", "0 is none");
        s.deadline_ms = back ? std::nullopt : std::optional(c.value);
        return back ? "the deadline is as configured" : fmt::format("the deadline is {:.6g} ms", c.value);
      }
      case CommandKind::kLook:
      case CommandKind::kReload:
        break;
    }
    refuse(fmt::format("no command has the kind {}", static_cast<int>(c.kind)),
           "see idl/msg/sextant_msgs/msg/Command.msg");
  }

  static CommandAnswer describe(const State& s, const Command& c, CommandResult result, std::string message) {
    CommandAnswer answer;
    answer.request_id = c.request_id;
    answer.kind = c.kind;
    answer.result = result;
    answer.message = std::move(message);
    for (const Known& model : s.models) {
      answer.objects.push_back({model.object_id, model.name, model.file.string(), model.enabled,
                                model.threshold ? model.threshold : s.options.threshold});
    }
    answer.region = s.region;
    answer.deadline_ms = s.deadline_ms.value_or(s.options.deadline_ms);
    return answer;
  }

  FrameResult search(const State& s, const RgbdFrame& frame, const std::vector<Look>& waiting) const {
    DetectCall call;
    call.stop = [this] { return cancelled.load(); };
    call.wanted = [&](const std::string& name) {
      const auto index = s.find(name);
      if (!index) return false;
      return s.models[*index].enabled || std::any_of(waiting.begin(), waiting.end(), [&](const Look& look) {
               return look.command.object_name.empty() || look.command.object_name == name;
             });
    };
    for (const Known& model : s.models) {
      if (model.threshold) call.thresholds[model.name] = *model.threshold;
    }
    call.deadline_ms = s.deadline_ms;
    if (s.region != ImageRegion{}) {
      std::copy(s.region.begin(), s.region.end(), call.image_region.emplace().begin());
    }
    if (search_elsewhere) search_elsewhere(frame, s.detector, call);
    return s.detector->detect(frame, call);
  }
};

namespace {

/// Only what concerns the objects that `keep` accepts.
FrameResult part_of(const FrameResult& result, const std::function<bool(const std::string&)>& keep) {
  FrameResult part = result;
  std::erase_if(part.estimates, [&](const PoseEstimate& e) { return !keep(e.object_name); });
  std::erase_if(part.objects, [&](const ObjectOutcome& o) { return !keep(o.object_name); });
  return part;
}

}  // namespace

DetectionService::DetectionService(DetectionSetup setup, ModelsChanged models_changed,
                                   SearchElsewhere search_elsewhere)
    : impl_(std::make_unique<Impl>()) {
  impl_->models_changed = std::move(models_changed);
  impl_->search_elsewhere = std::move(search_elsewhere);
  impl_->set(begin(std::move(setup)));
}

DetectionService::~DetectionService() = default;

FrameResult DetectionService::detect(const RgbdFrame& frame) {
  impl_->remember(frame);
  const std::shared_ptr<const State> s = impl_->now();
  const std::vector<Look> waiting = impl_->looks_for(frame);
  const auto tell = [&](const Look& look, CommandAnswer answer) { look.answer(std::move(answer)); };
  FrameResult result;
  try {
    const bool nothing_wanted =
        waiting.empty() &&
        std::none_of(s->models.begin(), s->models.end(), [](const Known& model) { return model.enabled; });
    if (s->detector && !nothing_wanted && !impl_->cancelled) {
      result = impl_->search(*s, frame, waiting);
    } else {
      result.captured_at = frame.captured_at;
      result.frame_id = frame.frame_id;
      result.sequence = frame.sequence;
      result.scene_id = frame.scene_id;
      result.image_id = frame.image_id;
    }
  } catch (const std::exception& error) {
    for (const Look& look : waiting)
      tell(look, answer_to(look.command, CommandResult::kFailed, error.what()));
    throw;
  }
  for (const Look& look : waiting) {
    if (impl_->cancelled) {
      tell(look, answer_to(look.command, CommandResult::kFailed, "the daemon is ending"));
      continue;
    }
    const double age_s = std::chrono::duration<double>(Clock::now() - frame.captured_monotonic).count();
    if (1e3 * age_s > s->max_look_age_ms) {
      tell(look, answer_to(look.command, CommandResult::kFailed,
                           fmt::format("the result was {:.0f} ms old, allowed are {:.0f} "
                                       "(pipeline.max_age_ms)",
                                       1e3 * age_s, s->max_look_age_ms)));
      continue;
    }
    const std::string& name = look.command.object_name;
    FrameResult part = part_of(result, [&](const std::string& n) { return name.empty() || n == name; });
    const std::size_t poses = part.estimates.size();
    CommandAnswer answer = answer_to(look.command, CommandResult::kDone,
                                     fmt::format("looked once: {} pose{}", poses, poses == 1 ? "" : "s"));
    answer.look = std::move(part);
    answer.look_age_s = age_s;
    tell(look, std::move(answer));
  }
  if (waiting.empty()) return result;
  return part_of(result, [&](const std::string& name) {
    const auto index = s->find(name);
    return index && s->models[*index].enabled;
  });
}

void DetectionService::cancel() { impl_->cancelled = true; }

CommandAnswer DetectionService::execute(const Command& command) {
  const std::lock_guard one_at_a_time(impl_->change_mutex);
  State next = *impl_->now();
  bool models_differ = false;
  try {
    std::string done = Impl::change(next, command, impl_->last_image_size(), models_differ);
    impl_->set(next);
    if (models_differ && impl_->models_changed) impl_->models_changed(next.copy_of_models());
    return answer_to(command, CommandResult::kDone, std::move(done));
  } catch (const UsageError& error) {
    return answer_to(command, CommandResult::kRefused, error.what());
  } catch (const DoorError& error) {
    return answer_to(command, CommandResult::kFailed, error.what());
  }
}

void DetectionService::look(const Command& command, std::function<void(const CommandAnswer&)> answer,
                            std::chrono::milliseconds patience, Clock::time_point now) {
  try {
    if (Impl::meant(*impl_->now(), command.object_name).empty())
      refuse("no model is loaded", "load one first");
    const std::lock_guard lock(impl_->mutex);
    if (impl_->looks.size() >= kMostLooks)
      refuse("too many looks are waiting for a frame", "ask again later");
    impl_->looks.push_back({command, answer, now, now + patience});
    return;
  } catch (const UsageError& error) {
    answer(answer_to(command, CommandResult::kRefused, error.what()));
  }
}

void DetectionService::expire_looks(Clock::time_point now) {
  std::vector<Look> expired;
  {
    const std::lock_guard lock(impl_->mutex);
    auto& looks = impl_->looks;
    const auto late = std::stable_partition(looks.begin(), looks.end(),
                                            [&](const Look& look) { return now < look.patience_ends; });
    expired.assign(std::make_move_iterator(late), std::make_move_iterator(looks.end()));
    looks.erase(late, looks.end());
  }
  for (const Look& look : expired) {
    look.answer(
        answer_to(look.command, CommandResult::kFailed, "no frame came to look at; is the camera there?"));
  }
}

void DetectionService::replace(DetectionSetup setup) {
  State next = begin(std::move(setup));
  const std::lock_guard one_at_a_time(impl_->change_mutex);
  impl_->set(next);
  if (impl_->models_changed) impl_->models_changed(next.copy_of_models());
}

CommandAnswer DetectionService::answer_to(const Command& command, CommandResult result,
                                          std::string message) const {
  return Impl::describe(*impl_->now(), command, result, std::move(message));
}

}  // namespace sextant
