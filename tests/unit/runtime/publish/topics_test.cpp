// SPDX-License-Identifier: Apache-2.0
#include "runtime/publish/topics.h"

#include <gtest/gtest.h>

#include "runtime/base/error.h"

namespace sextant {
namespace {

TEST(Topics, AreSpelledAsRos2SpellsThem) {
  EXPECT_EQ(dds_topic_name("", "detections"), "rt/detections");
  EXPECT_EQ(dds_topic_name("arm/left", "pose_estimates"), "rt/arm/left/pose_estimates");
  EXPECT_EQ(dds_topic_name("arm", "/tf"), "rt/tf");  // absolute: no namespace before it
  EXPECT_FALSE(is_topic_name("/tf"));
  EXPECT_TRUE(is_topic_path("/tf"));
}

TEST(Topics, RefuseNamesThatRos2Refuses) {
  for (const char* name :
       {"", "/", "//detections", "a//b", "detections/", "2d", "a/2d", "a b", "a-b", "a.b", "~a", "\n", "é"}) {
    EXPECT_FALSE(is_topic_name(name)) << name;
    EXPECT_FALSE(is_topic_path(name)) << name;
    EXPECT_THROW(dds_topic_name("", name), UsageError) << name;
  }
  EXPECT_THROW(dds_topic_name("/arm", "detections"), UsageError);
  EXPECT_TRUE(is_topic_name(std::string(200, 'a')));
  EXPECT_FALSE(is_topic_name(std::string(201, 'a')));
}

TEST(Topics, TellTheirKindByTheLastToken) {
  EXPECT_EQ(topic_kind_of("detections"), TopicKind::kDetections);
  EXPECT_EQ(topic_kind_of("arm/object_pose"), TopicKind::kObjectPose);
  EXPECT_EQ(topic_kind_of("a/b/pose_estimates"), TopicKind::kPoseEstimates);
  EXPECT_EQ(topic_kind_of("/tf"), TopicKind::kTf);
  EXPECT_EQ(topic_kind_of("arm/annotated/image_raw"), TopicKind::kAnnotated);
  EXPECT_EQ(topic_kind_of("diagnostics"), TopicKind::kDiagnostics);
  EXPECT_EQ(topic_kind_of("arm/command"), TopicKind::kCommand);
  EXPECT_EQ(topic_kind_of("command_answer"), TopicKind::kCommandAnswer);
  EXPECT_THROW(topic_kind_of("pose_estimates/raw"), UsageError);
}

TEST(Topics, RefuseDomainsWithoutPorts) {
  EXPECT_NO_THROW(check_domain(230));
  EXPECT_THROW(check_domain(231), UsageError);
}

}  // namespace
}  // namespace sextant
