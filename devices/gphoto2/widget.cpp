// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/widget.h"

#include <gphoto2/gphoto2-widget.h>

#include <cstdio>
#include <cstdlib>

namespace patina::devices::gphoto2 {

Setting settingOf(CameraWidget* widget) {
  Setting s;
  int read_only = 0;
  gp_widget_get_readonly(widget, &read_only);
  s.read_only = read_only != 0;
  CameraWidgetType type = GP_WIDGET_TEXT;
  gp_widget_get_type(widget, &type);
  if (type == GP_WIDGET_RANGE) {
    float v = 0;
    gp_widget_get_value(widget, &v);
    char text[32];
    std::snprintf(text, sizeof text, "%g", static_cast<double>(v));
    s.value = text;
  } else if (type == GP_WIDGET_TOGGLE || type == GP_WIDGET_DATE) {
    int v = 0;
    gp_widget_get_value(widget, &v);
    s.value = std::to_string(v);
  } else {
    const char* v = nullptr;
    gp_widget_get_value(widget, &v);
    s.value = v ? v : "";
  }
  for (int i = 0; i < gp_widget_count_choices(widget); ++i) {
    const char* choice = nullptr;
    if (gp_widget_get_choice(widget, i, &choice) >= 0 && choice) s.choices.emplace_back(choice);
  }
  return s;
}

int putValue(CameraWidget* widget, const std::string& value) {
  CameraWidgetType type = GP_WIDGET_TEXT;
  gp_widget_get_type(widget, &type);
  if (type == GP_WIDGET_RANGE) {
    const float v = std::strtof(value.c_str(), nullptr);
    return gp_widget_set_value(widget, &v);
  }
  if (type == GP_WIDGET_TOGGLE || type == GP_WIDGET_DATE) {
    const int v = static_cast<int>(std::strtol(value.c_str(), nullptr, 10));
    return gp_widget_set_value(widget, &v);
  }
  return gp_widget_set_value(widget, value.c_str());
}

void collectNames(CameraWidget* widget, std::vector<std::string>& names) {
  const int children = gp_widget_count_children(widget);
  const char* name = nullptr;
  gp_widget_get_name(widget, &name);
  if (children == 0 && name) names.emplace_back(name);
  for (int i = 0; i < children; ++i) {
    CameraWidget* child = nullptr;
    if (gp_widget_get_child(widget, i, &child) >= 0) collectNames(child, names);
  }
}

}  // namespace patina::devices::gphoto2
