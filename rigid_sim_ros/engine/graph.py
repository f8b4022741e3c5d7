# Copyright 2026 The rigid_sim_ros authors
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""What hangs together: connected components of bodies by their pairs."""

import numpy as np


def component_labels(count, body_a, body_b):
    """
    Return a label (count,) for each of `count` nodes: the smallest index of its component.

    The edges are `body_a`, `body_b`, (p,) each. Labels are spread along the edges and then
    followed to their roots, until nothing changes (Shiloach and Vishkin 1982): a few rounds
    whatever the shape of the graph.
    """
    labels = np.arange(count)
    while True:
        smaller = np.minimum(labels[body_a], labels[body_b])
        spread = labels.copy()
        np.minimum.at(spread, labels[body_a], smaller)
        np.minimum.at(spread, labels[body_b], smaller)
        while not np.array_equal(spread, followed := spread[spread]):
            spread = followed
        if np.array_equal(spread, labels):
            return labels
        labels = spread


def alike(labels):
    """Return (label, places (m,) int) for each of the labels (k,) there are, ascending."""
    order = np.argsort(labels, kind='stable')
    ordered = labels[order]
    changes = np.flatnonzero(ordered[1:] != ordered[:-1]) + 1
    bounds = [0, *changes.tolist(), len(labels)] if len(labels) else []
    # np.split would take as long for a part as this for ten
    return [(ordered.item(start), order[start:end]) for start, end in zip(bounds, bounds[1:])]


def contact_groups(bodies, contacts):
    """
    Return `Contacts` as a list of them, one for each set of moving bodies that hang together.

    What is fixed joins nothing.
    """
    if not contacts.count:
        return []
    a, b = contacts.body_a, contacts.body_b
    if bodies.inverse_mass[a[0]] > 0 and (a == a[0]).all():
        return [contacts]
    labels = _group_labels(bodies, a, b)
    if (labels == labels[0]).all():
        return [contacts]
    return [contacts.select(places) for _, places in alike(labels)]


def group_numbers(bodies, contacts):
    """Return the number (k,) of the group each of `Contacts` is in, as in `contact_groups`."""
    return np.unique(_group_labels(bodies, contacts.body_a, contacts.body_b),
                     return_inverse=True)[1]


def _group_labels(bodies, a, b):
    """Return the least index of the moving bodies that contacts of pairs (k,) hang together by."""
    moves = bodies.inverse_mass > 0
    both = moves[a] & moves[b]
    return component_labels(bodies.count, a[both], b[both])[np.where(moves[a], a, b)]


def lone_contacts(bodies, contacts):
    """Return which `Contacts`, (k,) bool, are the only one of each moving body in them."""
    if contacts.count <= 1:
        return np.ones(contacts.count, dtype=bool)
    sides = [contacts.body_a, contacts.body_b]
    touching = np.bincount(np.concatenate(sides), minlength=bodies.count)
    touching[bodies.moving_count:] = 0
    return (touching[sides[0]] <= 1) & (touching[sides[1]] <= 1)


def connected(pairs, moving_count):
    """
    Return the places (l,) int of a list of pairs (a, b) in groups that share a body, ascending.

    What has an index from `moving_count` on does not move and joins nothing. In plain Python, for
    lists so short that arrays would take longer.
    """
    group_of, groups = {}, []
    for place, pair in enumerate(pairs):
        joined = None
        for body in pair:
            if body >= moving_count:
                continue
            group = group_of.get(body)
            if group is None:
                if joined is None:
                    joined = ([], [])
                    groups.append(joined)
                group_of[body] = joined
                joined[1].append(body)
            elif joined is None:
                joined = group
            elif group is not joined:
                joined[0].extend(group[0])
                joined[1].extend(group[1])
                group[0].clear()
                for other in group[1]:
                    group_of[other] = joined
                groups.remove(group)
        joined[0].append(place)
    return [np.array(sorted(places)) for places, _ in groups]
