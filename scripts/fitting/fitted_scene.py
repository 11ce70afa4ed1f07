"""The scene's file with other numbers in it, and every comment where it was."""
import os

import yaml

from fitting import FitError


def _number(value):
    text = "%.6g" % value if isinstance(value, float) else str(value)
    return text.replace("e", ".0e") if "e" in text and "." not in text else text  # 1e-05 is a word to YAML 1.1


def text_of(value):
    """YAML, in one line."""
    if isinstance(value, dict):
        return "{%s}" % ", ".join("%s: %s" % (key, text_of(child)) for key, child in value.items())
    if isinstance(value, (list, tuple)):
        return "[%s]" % ", ".join(map(text_of, value))
    if isinstance(value, str):  # as an element of a flow list it is quoted wherever a comma or a bracket would end it
        return yaml.safe_dump([value], default_flow_style=True, allow_unicode=True, width=float("inf")).strip()[1:-1]
    return _number(value)


def _rounded(value):
    if isinstance(value, (list, tuple)):
        return [_rounded(child) for child in value]
    return float(_number(value)) if isinstance(value, float) else value


def _unshared(tree):
    """Without aliases: what is one thing in the file becomes several."""
    if isinstance(tree, dict):
        return {key: _unshared(child) for key, child in tree.items()}
    return [_unshared(child) for child in tree] if isinstance(tree, list) else tree


def _element(items, part, name_of):
    """Index of the element of a list that `part` names, as the simulator reads keys."""
    if part.isdigit() and int(part) < len(items):
        return int(part)
    named = [i for i, item in enumerate(items) if name_of(item) == part]
    if not named:
        raise FitError("the scene has no %s in a list of %d elements; give a name, a link or an index" % (part, len(items)))
    return named[0]


def _name_of(item):
    """What an element of a list goes by: its name, or else its link, or itself where it is a word."""
    if not isinstance(item, dict):
        return item if isinstance(item, str) else None
    return item.get("name", item.get("link"))


def _of_word(path, word):
    """What a word stands for where the scene may have a map: "material: liver". Of "refinement: auto" and "axis: fibre" nothing goes on."""
    if path[-1] == "material":
        return {"preset": word}
    short_for = {"contact_links": "link", "joint_state_topics": "topic"}.get(path[-2]) if len(path) > 1 else None
    return {short_for: word} if short_for else {}


def _set_in_tree(tree, path, value):
    for at, part in enumerate(path):
        last = at == len(path) - 1
        if isinstance(tree, list):
            part = _element(tree, part, _name_of)
        elif part not in tree:
            tree[part] = {}
        if not last and isinstance(tree[part], str):
            tree[part] = _of_word(path[:at + 1], tree[part])
        if last:
            tree[part] = value
        tree = tree[part]


def _child(node, part):
    """The node below, or None."""
    if isinstance(node, yaml.MappingNode):
        return next((value for key, value in node.value if key.value == part), None)

    def name_of(item):
        name = (_child(item, "name") or _child(item, "link")) if isinstance(item, yaml.MappingNode) else item
        return name.value if isinstance(name, yaml.ScalarNode) else None
    return node.value[_element(node.value, part, name_of)]


def _edit(root, path, value):
    """(start, end, text) that sets it, by characters of the file."""
    node = root
    for at, part in enumerate(path):
        if isinstance(node, yaml.ScalarNode):
            for missing in reversed(path[at + 1:]):
                value = {missing: value}
            return node.start_mark.index, node.end_mark.index, text_of({**_of_word(path[:at], node.value), part: value})
        below = _child(node, part)
        if below is None:
            for missing in reversed(path[at + 1:]):
                value = {missing: value}
            entry = "%s: %s" % (part, text_of(value))
            if not node.value:
                return node.start_mark.index, node.end_mark.index, "{%s}" % entry
            start = node.value[0][0].start_mark
            return start.index, start.index, entry + (", " if node.flow_style else "\n" + " " * start.column)
        node = below
    return node.start_mark.index, node.end_mark.index, text_of(value)


def _moved_paths(tree, folder, to_folder, path=()):
    """(path, value) of file names that are relative to the scene's folder, from another one."""
    items = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    for key, child in items:
        here = path + (str(key),)
        if key in ("file", "urdf") and isinstance(child, str) and not child.startswith(("/", "package://", "file://")):
            yield here, os.path.relpath(os.path.join(folder, child), to_folder)
        else:
            yield from _moved_paths(child, folder, to_folder, here)


def fitted_text(scene, settings, to_folder, heading):
    """settings: {key: value}; heading: comment lines that come first."""
    with open(scene, encoding="utf-8") as stream:
        text = stream.read()
    tree = yaml.safe_load(text)
    changes = [(tuple(key.split(".")), _rounded(value)) for key, value in settings.items()]
    wanted = _unshared(tree)
    for path, value in changes:
        _set_in_tree(wanted, path, value)
    moved = list(_moved_paths(wanted, os.path.dirname(os.path.abspath(scene)), os.path.abspath(to_folder)))  # settings' too
    for path, value in moved:
        _set_in_tree(wanted, path, value)
    for path, value in changes + moved:
        start, end, new = _edit(yaml.compose(text, yaml.SafeLoader), path, value)
        text = text[:start] + new + text[end:]
    if yaml.safe_load(text) != wanted:  # anchors, and whatever else is shared: right numbers go before comments
        text = yaml.safe_dump(wanted, sort_keys=False)
        if yaml.safe_load(text) != wanted:
            raise FitError("%s cannot be written with the fitted numbers" % scene)
    return "".join("# %s\n" % line for line in "\n".join(heading).splitlines()) + text
