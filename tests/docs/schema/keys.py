"""Which keys a schema knows at a place of a document."""
import jsonschema


def resolved(schema, root):
    while "$ref" in schema:
        node = root
        for part in schema["$ref"].lstrip("#/").split("/"):
            node = node[part]
        schema = node
    return schema


def holds(schema, root, instance):
    return jsonschema.Draft7Validator({**schema, "definitions": root.get("definitions", {})}).is_valid(instance)


def applied(schema, root, instance):
    """The schema, and all schemas within it that judge this instance itself."""
    schema = resolved(schema, root)
    yield schema
    for one in schema.get("allOf", []):
        yield from applied(one, root, instance)
    for word in ("anyOf", "oneOf"):
        for one in schema.get(word, []):
            if holds(one, root, instance):
                yield from applied(one, root, instance)
    if "if" in schema:
        branch = "then" if holds(schema["if"], root, instance) else "else"
        if branch in schema:
            yield from applied(schema[branch], root, instance)


def below(schemas, key, root, instance):
    """The schemas of a value by the schemas of the map or list that holds it."""
    for schema in schemas:
        if isinstance(key, int):
            inner = schema.get("items")
        else:
            more = schema.get("additionalProperties")
            inner = schema.get("properties", {}).get(key, more if isinstance(more, dict) else None)
        if inner is not None:
            yield from applied(inner, root, instance)


def maps_of(instance, schema, root):
    """(path, map, schemas) of every map of a document that validates."""

    def walk(value, schemas, path):
        schemas = list(schemas)
        if isinstance(value, dict):
            yield path, value, schemas
            for key, inner in value.items():
                yield from walk(inner, below(schemas, key, root, inner), path + [key])
        elif isinstance(value, list):
            for i, inner in enumerate(value):
                yield from walk(inner, below(schemas, i, root, inner), path + [i])

    yield from walk(instance, applied(schema, root, instance), [])


def closed(schema):
    """Whether the schema names all keys of a map."""
    return schema.get("additionalProperties") is False


def known_keys(schemas):
    return {key for schema in schemas if closed(schema) for key in schema["properties"]}


def closed_maps(schema):
    """Every schema in a file that names all keys of a map."""
    if isinstance(schema, dict):
        if closed(schema):
            yield schema
        for inner in schema.values():
            yield from closed_maps(inner)
    elif isinstance(schema, list):
        for inner in schema:
            yield from closed_maps(inner)
