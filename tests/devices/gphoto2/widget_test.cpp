// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/widget.h"

#include <gmock/gmock.h>
#include <gphoto2/gphoto2-widget.h>
#include <gtest/gtest.h>

#include <memory>

namespace patina::devices::gphoto2 {
namespace {

using ::testing::ElementsAre;

struct Free {
  void operator()(CameraWidget* widget) const { gp_widget_free(widget); }
};
using Owned = std::unique_ptr<CameraWidget, Free>;

CameraWidget* made(CameraWidgetType type, const char* name) {
  CameraWidget* widget = nullptr;
  gp_widget_new(type, name, &widget);
  gp_widget_set_name(widget, name);
  return widget;
}

TEST(Widget, AChoiceComesBackWithAllThereAre) {
  const Owned iso(made(GP_WIDGET_RADIO, "iso"));
  gp_widget_add_choice(iso.get(), "100");
  gp_widget_add_choice(iso.get(), "200");
  EXPECT_GE(putValue(iso.get(), "200"), 0);
  const Setting setting = settingOf(iso.get());
  EXPECT_EQ(setting.value, "200");
  EXPECT_THAT(setting.choices, ElementsAre("100", "200"));
  EXPECT_FALSE(setting.read_only);
}

TEST(Widget, NumbersAndSwitchesAreTextsToo) {
  const Owned range(made(GP_WIDGET_RANGE, "zoom")), toggle(made(GP_WIDGET_TOGGLE, "bulb"));
  gp_widget_set_range(range.get(), 0, 10, 0.5F);
  EXPECT_GE(putValue(range.get(), "2.5"), 0);
  EXPECT_EQ(settingOf(range.get()).value, "2.5");
  EXPECT_GE(putValue(toggle.get(), "1"), 0);
  EXPECT_EQ(settingOf(toggle.get()).value, "1");
}

TEST(Widget, NamesAreThoseOfTheLeaves) {
  const Owned root(made(GP_WIDGET_WINDOW, "main"));
  CameraWidget* section = made(GP_WIDGET_SECTION, "capture");
  gp_widget_append(root.get(), section);
  gp_widget_append(section, made(GP_WIDGET_TEXT, "artist"));
  std::vector<std::string> names;
  collectNames(root.get(), names);
  EXPECT_THAT(names, ElementsAre("artist"));
}

}  // namespace
}  // namespace patina::devices::gphoto2
