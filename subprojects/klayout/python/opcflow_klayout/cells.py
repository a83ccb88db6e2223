# SPDX-License-Identifier: BSD-3-Clause
"""Writes the current cell or the selection of a view to a GDSII file."""
import pya


def copy_layers(source, target):
    """Create the layers of the layout `source` in `target`. Returns indices by source index."""
    return {layer: target.layer(source.get_info(layer)) for layer in source.layer_indexes()}


def copy_selection(source, objects, target, top):
    """Copy selected shapes and instances (ObjectInstPath) to the cell `top` of `target`."""
    layers, cells = copy_layers(source, target), {}
    for path in objects:
        if not path.is_cell_inst():
            top.shapes(layers[path.layer]).insert(path.shape, path.trans())
            continue
        instance = path.inst()
        index = instance.cell_index
        if index not in cells:
            cells[index] = target.create_cell(source.cell_name(index))
            cells[index].copy_tree(source.cell(index))
        array = instance.cell_inst.dup()
        array.cell_index = cells[index].cell_index()
        array.transform(path.source_trans())
        top.insert(array)


def write(cellview, path, objects=()):
    """Write the selected `objects` of the cell view, or without objects the current cell, to a
    GDSII file. The coordinates are those of the view."""
    source, target = cellview.layout(), pya.Layout()
    target.dbu = source.dbu
    top = target.create_cell(cellview.cell.name)
    if objects:
        copy_selection(source, objects, target, top)
    else:
        top.copy_tree(cellview.cell)
    if not cellview.context_trans().is_unity():
        target.transform(cellview.context_trans())
    target.write(path)
