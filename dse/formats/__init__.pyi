from .compose import MOST_LEVELS as MOST_LEVELS, UNSAFE as UNSAFE, unsafe as unsafe
from .parse_cache import WRITTEN as WRITTEN, read_kept as read_kept, remember as remember
from .xml import (
    UNBOUND as UNBOUND,
    XmlElement as XmlElement,
    flag_of as flag_of,
    read_xml as read_xml,
    read_xml_file as read_xml_file,
    real_of as real_of,
    shortened as shortened,
    whole_of as whole_of,
    xml_content as xml_content,
)
from .yaml import (
    Call as Call,
    Document as Document,
    Entry as Entry,
    KeyPath as KeyPath,
    Mark as Mark,
    read_yaml as read_yaml,
    shown as shown,
)
from .yaml_text import (
    dump_yaml as dump_yaml,
    inline as inline,
    write_data as write_data,
    write_file as write_file,
    write_flow as write_flow,
    write_name as write_name,
    write_parameter as write_parameter,
    write_scalar as write_scalar,
    write_text as write_text,
    write_value as write_value,
)
from .zip import (
    digest_of as digest_of,
    pack_zip as pack_zip,
    passed_over as passed_over,
    unpack_zip as unpack_zip,
    unpacked as unpacked,
)
